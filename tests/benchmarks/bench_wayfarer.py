"""What the perimeter costs. Run it by hand: `python tests/benchmarks/bench_wayfarer.py`.

Takes: nothing. Gives: a line for each core: processor time of a call, the best of several batches, and the most it
may be; and for each preset how many simulated seconds the whole loop (world, sensors, plan, judge) makes of one second
of processor time, the median of several runs without a recording. Leaves alone: the time by a clock on the wall, which
depends on what else the machine does.
"""

from __future__ import annotations

import itertools
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from behaviours.catalogue import LIBRARIES
from behaviours.cores import svfh
from behaviours.cores.contour import ContourSettings, rolled, snapped
from behaviours.cores.flippers import Labour, LabourSettings
from behaviours.cores.hough import HoughSettings, lines
from behaviours.cores.hybrid import HeadingModel, compared, first_belief, moved
from behaviours.cores.look_ahead import LookAheadSettings, way
from behaviours.cores.occupancy import OccupancyGrid, OccupancySettings
from behaviours.cores.patches import PatchWriter
from behaviours.cores.pilot import PilotSettings, Surrounds, towards
from behaviours.cores.recent_path import Trace, TraceSettings
from behaviours.cores.stasis import CycleSettings, profile, repeats, stood_still
from behaviours.cores.vfh_plus import VfhPlus, VfhPlusSettings
from behaviours.interface import Drive, Floats, Pose, Scan
from rplan.apps.simulation import load_world
from rplan.apps.sweep.work import Change, changed
from rplan.apps.wiring import PlanBrain, compile_file
from sim.episode import Episode

BATCH, BATCHES = 100, 20
SECONDS, RUNS, LEAST = 60.0, 3, 60.0
"""[s] of the auxiliary building, so often; the factor that the loop must keep to."""
FOLDER = Path(__file__).parents[2] / "plans" / "perimeter"


def microseconds(work: Callable[[], object]) -> float:
    """Per call."""
    best = float("inf")
    for _ in range(BATCHES):
        start = time.process_time()
        for _ in range(BATCH):
            work()
        best = min(best, time.process_time() - start)
    return best / BATCH * 1e6


def scan(beams: int = 360, sd: float = 0.02) -> Floats:
    """What a lidar sees in a room of 16 m, 1.5 m off a wall."""
    bearings = np.arange(beams) * np.pi * 2 / beams
    c, s = np.cos(bearings + 0.03), np.sin(bearings + 0.03)
    with np.errstate(divide="ignore"):
        across, along = np.where(c > 0, 7.0, -9.0) / c, np.where(s > 0, 1.5, -14.5) / s
    reach = np.minimum(across, along) + sd * np.random.default_rng(0).standard_normal(beams)
    points: Floats = reach[:, None] * np.column_stack([np.cos(bearings), np.sin(bearings)])
    return points


@dataclass(frozen=True, slots=True)
class Row:
    """limit [us] that the core must keep to."""

    name: str
    limit: float
    work: Callable[[], object]


def hough() -> Row:
    """All lines of a scan, fitted."""
    points, settings = scan(), HoughSettings()
    return Row("Hough transform of 360 points", 200.0, lambda: lines(points, settings))


def contour() -> Row:
    """One roll of the disc, for which the points have been put on their lines."""
    settings = ContourSettings()
    points = snapped(scan(), lines(scan(), HoughSettings()), settings.snap)
    return Row("disc along a contour of 360 points", 200.0, lambda: rolled(points, (0.0, 1.5), 1.5, settings))


def sweep(far: float) -> Scan:
    """A scan of 361 beams, none of which meets anything nearer than `far`."""
    bearings = np.arange(1, 362) / 361 * np.pi * 2 - np.pi
    return Scan(0.0, True, Pose(0.0, 0.0, 0.0), bearings, np.full(361, far), 0.05, 20.0)


def grid() -> Row:
    """All beams free to their 20 m: the most cells."""
    occupancy, far = OccupancyGrid(OccupancySettings()), sweep(20.0)
    return Row("grid, 361 beams of 20 m", 1000.0, lambda: occupancy.add(far, Pose(0.1, 0.1, 0.3)))


def patch() -> Row:
    """What changed in 40 m by 40 m, compressed: once a second."""
    occupancy, writer = OccupancyGrid(OccupancySettings()), PatchWriter(0.2, 40.0)
    scans = [sweep(far) for far in (3.0, 8.0)]
    turns = itertools.cycle(scans)

    def work() -> object:
        occupancy.add(next(turns), Pose(0.1, 0.1, 0.3))
        return writer.delta(occupancy, 0.0, 0.0)

    return Row("grid and a patch of its changes", 5000.0, work)


def heading() -> Row:
    """One tick of the filter: compass, gyroscope and odometry."""
    model = HeadingModel()
    belief = first_belief(0.1, model, by_compass=True)
    return Row("filter of the heading", 200.0, lambda: compared(moved(belief, 0.01, 0.05, 0.1, 0.1, model), 0.1, model))


def recent_path() -> Row:
    """One tick of the path by distance, its dead ends and all."""
    trace, ticks = Trace(TraceSettings(by_distance=True)), itertools.count()

    def work() -> object:
        at = 0.05 * next(ticks)
        trace.add(2 * at, (at, 0.0))
        return trace.apart((at, 0.0))

    return Row("recent path", 100.0, work)


def slip() -> Row:
    """Whether a scan looks as before, or as it should after the motion that tracks claim."""
    points = scan()
    before = profile(points)
    return Row("motion by two scans", 200.0, lambda: stood_still(before, profile(points + 0.1), profile(points), 0.05))


def cycle() -> Row:
    """Whether half a minute of poses repeats itself: twice a second."""
    t = np.arange(60) / 2
    poses = np.column_stack([0.5 * t, np.sin(t / 9), np.cos(t / 9), np.sin(t / 9)])
    return Row("motion that repeats itself", 1000.0, lambda: repeats(poses, CycleSettings()))


def labour() -> Row:
    """One reading of the motors' currents."""
    machine, ticks = Labour(LabourSettings()), itertools.count()
    return Row("state machine of the flippers", 20.0, lambda: machine.take(next(ticks) / 10, 1.5, 16.0))


def scaled() -> Row:
    """The histogram of a scan, a direction and a command, among things on every side."""
    points, settings = crowded(), svfh.SvfhSettings()

    def work() -> object:
        direction = svfh.chosen_direction(svfh.histogram(points, settings) < settings.threshold, 0.3, True)
        return svfh.drive(direction, True, svfh.front_range(points, settings), True, settings)

    return Row("SVFH of 361 points", 100.0, work)


def vfh() -> Row:
    """The histogram of VFH+ and a direction."""
    points, plus = crowded(), VfhPlus(VfhPlusSettings(), left=True)
    return Row("VFH+ of 361 points", 1000.0, lambda: plus.choose(points, 0.1, 0.3, 0.3))


def pilot() -> Row:
    """A command that leaves the hull free, at full speed."""
    points, now = crowded(), Drive(0.5, 0.0)
    return Row("pilot, 361 points", 2000.0, lambda: towards(0.3, now, Surrounds(points), PilotSettings()))


def look_ahead() -> Row:
    """A way through what is seen, 4 m to every side: five times a second."""
    points, nothing = crowded(), np.zeros((0, 2))
    return Row("looking ahead, 361 points", 20000.0, lambda: way(points, 0.3, nothing, LookAheadSettings()))


def crowded(beams: int = 361) -> Floats:
    """What a lidar sees among things from 0.7 m to 3.9 m away."""
    bearings = np.arange(beams) * np.pi * 2 / beams
    reach = np.repeat(np.random.default_rng(0).uniform(0.7, 3.9, beams // 10 + 1), 10)[:beams]
    points: Floats = reach[:, None] * np.column_stack([np.cos(bearings), np.sin(bearings)])
    return points


ROWS: tuple[Callable[[], Row], ...] = (
    *(hough, contour, grid, patch, heading, recent_path, slip, cycle, labour),
    *(scaled, vfh, pilot, look_ahead),
)


def real_time_factor(preset: str) -> float:
    """Simulated seconds for each second of processor time, nobody looking at the views."""
    plan, world = compile_file(FOLDER / "perimeter.rplan"), load_world(FOLDER / "worlds" / "auxiliary.yaml")
    names = [bound.name for bound in plan.goals.libraries]
    known = [name for name in names if any(p.name == "preset" for p in LIBRARIES[name].parameters)]
    brain = PlanBrain(changed(plan, [Change(name, "preset", preset) for name in known]), looked_at=False)
    factors: list[float] = []
    for _ in range(RUNS):
        episode = Episode(world.scenario, 0, plan.goals.period)
        start = time.process_time()
        episode.run(brain, SECONDS)
        factors.append(SECONDS / (time.process_time() - start))
    return statistics.median(factors)


def warm() -> None:
    """Free a large array, as every run does: until then the allocator gives the memory of small ones back each time."""
    np.zeros(1 << 19).sum()


def main() -> None:
    """Print a line for each row, and one for each preset."""
    warm()
    for make in ROWS:
        row = make()
        print(f"{row.name:40} {microseconds(row.work):7.1f} us of {row.limit:.0f}", flush=True)
    for preset in ("paper", "modern"):
        name = f"whole loop, auxiliary building, {preset}"
        print(f"{name:40} {real_time_factor(preset):7.1f} x real time, at least {LEAST:.0f}", flush=True)


if __name__ == "__main__":
    main()
