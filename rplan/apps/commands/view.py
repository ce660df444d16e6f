"""`rplan view PLAN`: watch a plan while its simulation runs."""

from __future__ import annotations

import asyncio
import signal
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import click

from rplan.apps import talk
from rplan.apps.files import InputError, plan_file, scenario_file, unreadable
from rplan.lang.diagnostic import PlanError

if TYPE_CHECKING:
    from rplan.apps.viewer.session import Session
    from rplan.driver import Compiled


@click.command("view", short_help="Watch a plan while its simulation runs.")
@click.argument("plan")
@click.option("--scenario", help="As in `simulate`. Default: the only one beside the plan.")
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0), help="Everything by chance follows it.")
@click.option("--port", default=0, type=click.IntRange(0, 65535), help="Where to listen. Default: any that is free.")
@click.option("--record", type=click.Path(dir_okay=False, path_type=Path), help="Write a recording (MCAP) as it runs.")
@click.option("--paused", is_flag=True, help="Wait for the page's play button.")
@click.option("--allow-holes", is_flag=True, help="Drive a plan that has a hole.")
@talk.with_libraries
def command(
    plan: str, scenario: str | None, seed: int, port: int, record: Path | None, paused: bool, allow_holes: bool
) -> None:
    """Simulate PLAN and show it live on a page of this machine: what it senses, decides and does, and why.

    On the page one can pause, step, go back to what was, drag things, force percepts and stop at rules. Ctrl-C ends
    it.
    """
    if find_spec("websockets") is None:
        raise InputError("rplan view needs websockets: pip install 'rplan[view]'")
    path = plan_file(plan)
    compiled = talk.compiled(path, allow_holes=allow_holes)
    session = _session(compiled, path, scenario_file(scenario, path), seed)
    session.wishes.running = not paused
    try:
        asyncio.run(_watch(session, port, record))
    except KeyboardInterrupt:
        pass
    except OSError as error:
        raise InputError(f"port {port} of 127.0.0.1: {error.strerror or error}") from None
    click.echo(f"ended at {session.episode.time:.1f} s of simulated time")
    for written in session.recorded:
        click.echo(f"wrote {written}")
    if session.unwritten:
        raise InputError(session.unwritten)


def _session(compiled: Compiled, path: Path, scenario: Path, seed: int) -> Session:
    from rplan.apps.simulation import world_in
    from rplan.apps.viewer.session import Session
    from sim.scenarios.schema import ScenarioError

    world = world_in(scenario)
    try:
        return Session(compiled, world, seed, talk.libraries())
    except PlanError as error:
        talk.wrong(error, path)
    except ScenarioError as error:
        told = [f"{scenario.name}, seed {seed}: {one.path}: {one.message}" for one in error.problems]
        raise InputError("\n".join(told)) from None


async def _watch(session: Session, port: int, record: Path | None) -> None:
    from rplan.apps.viewer.server import Viewer, watch

    def ready(viewer: Viewer) -> None:
        if record is not None:
            _record(session, record)
        click.echo(f"watch it at {viewer.address}  (Ctrl-C ends)")

    stop = asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        asyncio.get_running_loop().add_signal_handler(number, stop.set)
    await watch(session, port, ready, stop)


def _record(session: Session, path: Path) -> None:
    """Not before the port holds: what is there already is replaced."""
    try:
        session.record(path)
    except OSError as error:
        unreadable(path, error)
