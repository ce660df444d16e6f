"""One episode of an experiment, recorded, to be looked at.

Takes: a row with a preset, the name of a case, a seed. Gives: a page that plays the episode, a picture of it, or the
maps that were drawn on it. Leaves alone: measuring.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from PIL import Image

from rplan.apps.drawing import map as maps
from rplan.apps.files import InputError
from rplan.apps.reproduce.experiment import Asked, plan_at, scenario_at, variant_of
from rplan.apps.reproduce.row import Case, Seen
from rplan.apps.reproduce.watch import watch
from rplan.apps.simulation import Run, World, lasted, load_world, simulate
from rplan.apps.sweep.work import changed
from rplan.apps.viewer.page import write_page
from rplan.apps.wiring import compile_file
from rplan.lang.suggest import close
from sim.recording import Recording, read
from sim.scenarios.format import loads

GAP = 12
"""Pixels between maps side by side."""


@dataclass(frozen=True, slots=True)
class Shown:
    """Which episode."""

    asked: Asked
    case: Case


def find(asked: Asked, seeds: int, name: str | None) -> Shown:
    """The case of this name, without one the first. Raises InputError."""
    cases = asked.row.cases_with(asked.preset, seeds)
    if not cases:
        raise InputError(f"{asked.row.name} drives nothing: there is nothing to replay")
    if name is None:
        return Shown(asked, cases[0])
    for case in cases:
        if case.name == name:
            return Shown(asked, case)
    names = [case.name for case in cases]
    meant = close(name, names)
    hint = f"did you mean '{meant}'?" if meant else f"there are: {', '.join(names)}"
    raise InputError(f"{asked.row.name} has no case '{name}' ({hint})")


@contextmanager
def recorded(shown: Shown, seed: int) -> Iterator[tuple[Run, Recording]]:
    """The episode, driven and recorded for as long as it is looked at. Raises GridError, ScenarioError, OSError."""
    file = plan_at(shown.case.plan)
    compiled = compile_file(file)
    world = load_world(scenario_at(shown.case.scenario, file))
    variant = variant_of(shown.asked, shown.case, world, compiled)
    scenario = World(loads(variant.text, variant.file), variant.text)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.mcap"
        run = simulate(changed(compiled, variant.changes), scenario, seed, record=path)
        yield run, read(path)


def in_words(run: Run) -> str:
    """What came of it."""
    verdict = run.verdict
    return f"done in {lasted(verdict.duration)}" if verdict.done else f"not done: {verdict.reason}"


def seen(shown: Shown, seed: int) -> Seen:
    """The episode, tick by tick. Raises GridError, ScenarioError."""
    file = plan_at(shown.case.plan)
    compiled = compile_file(file)
    variant = variant_of(shown.asked, shown.case, load_world(scenario_at(shown.case.scenario, file)), compiled)
    return watch(changed(compiled, variant.changes), loads(variant.text, variant.file), seed)


def replay(shown: Shown, seed: int | None, file: Path) -> str:
    """Write the page, and say what came of the episode; without a seed the first of the case."""
    chosen = shown.case.seeds[0] if seed is None else seed
    with recorded(shown, chosen) as (run, recording):
        said = f"{shown.asked.row.name} ({shown.asked.preset}), {shown.case.name}, seed {chosen}: {in_words(run)}"
        write_page(recording, file, said)
    return said


def picture(shown: Shown, seed: int, file: Path) -> None:
    """Draw the lot with the way that was driven. Raises ImportError without matplotlib."""
    from rplan.apps.drawing.plot import draw

    with recorded(shown, seed) as (run, recording):
        draw(recording, file, f"{shown.asked.row.name}, {shown.case.name}: {in_words(run)}")


def draw_maps(shown: Shown, seed: int, file: Path) -> None:
    """Draw the maps that the row has of this episode, side by side, each from a run of its own."""
    with tempfile.TemporaryDirectory() as folder:
        drawn = [Path(folder) / f"{k}.png" for k in range(len(shown.asked.row.maps))]
        for wanted, path in zip(shown.asked.row.maps, drawn, strict=True):
            case = replace(shown.case, changes=(*shown.case.changes, *wanted.changes))
            with recorded(Shown(shown.asked, case), seed) as (_, recording):
                maps.draw(maps.gather(recording), path)
        _side_by_side([_opened(path) for path in drawn]).save(file, format="png")


def _opened(path: Path) -> Image.Image:
    with Image.open(path) as image:
        return image.convert("RGB")


def _side_by_side(images: list[Image.Image]) -> Image.Image:
    """All of the height of the lowest."""
    height = min(image.height for image in images)
    images = [image.resize((max(1, round(image.width * height / image.height)), height)) for image in images]
    whole = Image.new("RGB", (sum(image.width for image in images) + GAP * (len(images) - 1), height), "white")
    left = 0
    for image in images:
        whole.paste(image, (left, 0))
        left += image.width + GAP
    return whole
