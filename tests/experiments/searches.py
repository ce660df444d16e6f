"""The two searches over many seeds: how often they find the donor, and how well.

Takes: seeds, worlds of plans/find_and_fetch/worlds. Gives: a table of counts. Leaves alone: the fetching.
Run it with `python tests/experiments/searches.py --seeds 100`.
"""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass, field
from pathlib import Path

from behaviours.estimators.donor import DonorMemory
from behaviours.estimators.ir_search import IrSearch
from behaviours.estimators.stereo_search import StereoSearch
from behaviours.interface import Estimator, wrap
from rplan.apps.simulation import load_world
from rplan.apps.wiring import PlanBrain, compile_file, compile_source
from rplan.driver import Compiled
from rplan.lang.source import Source
from sim.episode import Episode
from sim.frames import bearing

PLANS = Path(__file__).parents[2] / "plans"
WORLDS = PLANS / "find_and_fetch" / "worlds"
FETCH = PLANS / "find_and_fetch" / "find_and_fetch.rplan"


@dataclass(slots=True)
class Watched:
    """What the searches of one run did. Angles [rad], lengths [m], moments [s]; nan where there is nothing to say."""

    sweeps: int = 0
    reasons: list[str] = field(default_factory=list)
    sun: bool = False
    angle_error: float = math.nan
    ranges: int = 0
    range_found: float = math.nan
    range_true: float = math.nan
    forgotten: list[tuple[float, str]] = field(default_factory=list)
    located: float = math.nan


class Searcher:
    """A run that is watched from within. until: "direction", "range" or "end"; sweeps: give up after so many."""

    def __init__(self, compiled: Compiled, world: str, seed: int) -> None:
        self.brain = PlanBrain(compiled)
        self.brain.reset()
        self.episode = Episode(load_world(WORLDS / f"{world}.yaml").scenario, seed)
        self.watched = Watched()
        self._phases = ("idle", "idle")
        self._why = ""

    def estimator(self, kind: type[Estimator]) -> Estimator:
        """The robot's own."""
        return next(e for e in self.brain._controller.crew.estimators if isinstance(e, kind))

    def run(self, until: str, sweeps: int = 1, limit: float = math.inf) -> Watched:
        """Until the search has come to its end."""
        watched = self.watched
        while self.episode.time < min(limit, self.episode.scenario.time_limit) and not self.episode.judge.over:
            self.episode.tick(self.brain)
            self._look()
            if until == "direction" and (not math.isnan(watched.angle_error) or len(watched.reasons) >= sweeps):
                break
            if until == "range" and (watched.ranges or len(watched.reasons) >= sweeps):
                break
        self.brain.close()
        return watched

    def _look(self) -> None:
        ir, stereo, donor = (self.estimator(kind) for kind in (IrSearch, StereoSearch, DonorMemory))
        assert isinstance(ir, IrSearch) and isinstance(stereo, StereoSearch) and isinstance(donor, DonorMemory)
        before, self._phases = self._phases, (ir.phase, stereo.phase)
        if ir.phase == "running" and before[0] != "running":
            self.watched.sweeps += 1
        if ir.phase == "done" and before[0] == "running":
            self._end_sweep(ir)
        if stereo.phase == "done" and before[1] == "running":
            self._end_ranging(stereo)
        if donor.is_located() and math.isnan(self.watched.located):
            self.watched.located = self.episode.time
        if donor.why_forgotten != self._why:
            self._why = donor.why_forgotten
            self.watched.forgotten.append((self.episode.time, self._why))

    def _end_sweep(self, ir: IrSearch) -> None:
        world = self.episode.world
        if ir.direction is None:
            self.watched.reasons.append(ir.reason)
            self.watched.sun = ir.suspects_sun
        else:
            donor = world.donors[0]
            true = bearing(world.robot.pose, (donor.x, donor.y))
            told = wrap(ir.direction.bearing - world.sense().odometry.pose.theta)
            self.watched.angle_error = abs(wrap(told - true))

    def _end_ranging(self, stereo: StereoSearch) -> None:
        world = self.episode.world
        self.watched.ranges += 1
        self.watched.range_true = world.donor_gaps[0] + world.robot.build.radius
        self.watched.range_found = math.nan if stereo.found is None else stereo.found.ground


def paper() -> Compiled:
    """The plan of the paper."""
    return compile_file(FETCH)


def from_horizon() -> Compiled:
    """The same with ranging from the horizon down."""
    text = FETCH.read_text(encoding="utf-8").replace("(use stereo-search)", "(use stereo-search :from-horizon on)")
    return compile_source(Source(str(FETCH), text))


def _directions(compiled: Compiled, seeds: int) -> list[str]:
    rows = []
    for world in ("ir_24ft", "ir_28ft", "ir_sun", "ir_sun_blocked"):
        runs = [Searcher(compiled, world, seed).run("direction") for seed in range(seeds)]
        good = sum(run.angle_error <= math.radians(2.0) for run in runs)
        found = sum(not math.isnan(run.angle_error) for run in runs)
        sun = sum(run.sun for run in runs)
        rows.append(f"{world}: found {found}/{seeds}, within 2 degrees {good}/{seeds}, sun suspected {sun}/{seeds}")
    runs = [Searcher(compiled, "ir_wind", seed).run("direction", sweeps=20) for seed in range(seeds)]
    retries = [len(run.reasons) for run in runs]
    within = sum(run.angle_error <= math.radians(2.0) for run in runs)
    rows.append(
        f"ir_wind: mean retries {sum(retries) / seeds:.2f}, most {max(retries)}, within 2 degrees {within}/{seeds}"
    )
    return rows


def _ranges(compiled: Compiled, world: str, seeds: int) -> str:
    runs = [Searcher(compiled, world, seed).run("range", sweeps=3) for seed in range(seeds)]
    good = sum(abs(run.range_found - run.range_true) <= 0.3 for run in runs)
    none = sum(math.isnan(run.range_found) for run in runs)
    told = sorted(run.range_found for run in runs if not math.isnan(run.range_found))
    middle = f", median {told[len(told) // 2]:.2f} m" if told else ""
    return f"{world}: within 0.3 m {good}/{seeds}, no range {none}/{seeds}{middle}"


def _moves(compiled: Compiled, seeds: int) -> str:
    delays = []
    done = 0
    for seed in range(seeds):
        searcher = Searcher(compiled, "donor_moves", seed)
        donor = searcher.episode.world.donors[0]
        start, moved = (donor.x, donor.y), math.nan
        while not searcher.episode.judge.over and searcher.episode.time < searcher.episode.scenario.time_limit:
            searcher.episode.tick(searcher.brain)
            searcher._look()
            if math.isnan(moved) and (donor.x, donor.y) != start:
                moved = searcher.episode.time
        noticed = [at for at, why in searcher.watched.forgotten if why == "the donor has moved" and at >= moved]
        delays.append(noticed[0] - moved if noticed else math.inf)
        done += searcher.episode.judge.done
    within = sum(delay <= 5.0 for delay in delays)
    return f"donor_moves: restarted within 5 s {within}/{seeds}, latest {max(delays):.1f} s, fetched {done}/{seeds}"


def main() -> None:
    """Print every row."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=20, help="how many")
    seeds = parser.parse_args().seeds
    plan, modern = paper(), from_horizon()
    for row in _directions(plan, seeds):
        print(row, flush=True)
    for world in ("donor_10ft", "donor_16ft", "donor_23ft", "donor_26ft", "donor_behind_box"):
        print("paper", _ranges(plan, world, seeds), flush=True)
    for world in ("donor_10ft", "donor_23ft", "donor_behind_box"):
        print("from-horizon", _ranges(modern, world, seeds), flush=True)
    print(_moves(plan, max(1, seeds // 4)))


if __name__ == "__main__":
    main()
