"""`rplan view`: what a session does with wishes, who is let in, and that it ends cleanly."""

from __future__ import annotations

import asyncio
import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import InvalidStatus
from websockets.typing import Origin

from behaviours.interface import Pose, Reading
from rplan.apps.cli import cli
from rplan.apps.commands import view
from rplan.apps.simulation import World, load_world, simulate
from rplan.apps.viewer.server import Viewer, watch
from rplan.apps.viewer.session import Session, WishError
from rplan.apps.wiring import PlanBrain, compile_file, compile_source
from rplan.goals.condition import Comparison
from rplan.lang.source import Source
from sim.recording import read
from sim.replay import pack

PLANS = Path(__file__).parents[2] / "plans"
FIND = PLANS / "find_and_fetch" / "find_and_fetch.rplan"
LOT = PLANS / "find_and_fetch" / "parking_lot.yaml"
ROOT = Path(__file__).parents[2]
STANDING = """(plan standing :period 0.1s)
(use robot)
(defoutput action command :idle (stop))
(defgoalr (maint safe) (if (heard) (do action (flee)) (do anything)))
(goalem (maint safe))
"""


def session(seed: int = 0) -> Session:
    return Session(compile_file(FIND), load_world(LOT), seed)


def note(one: Session) -> dict[str, Any]:
    """The plan's part of the last tick."""
    return {name: run.last for name, run in one.packing.runs.items()}


# --- the session -----------------------------------------------------------------------------------


def test_what_is_watched_is_the_run_that_is_simulated(tmp_path: Path) -> None:
    simulate(compile_file(FIND), load_world(LOT), 3, until=3.0, record=tmp_path / "run.mcap")
    recorded: Any = pack(read(tmp_path / "run.mcap"))
    one = session(3)
    one.wish({"do": "step", "ticks": 30})
    watched: Any = one.data()
    assert watched["ticks"] == recorded["ticks"] == 31
    for name in ("robot", "odometry", "sonar", "head"):
        assert watched["tracks"][name]["columns"][0][:9] == recorded["tracks"][name]["columns"][0][:9]
    assert watched["runs"]["inputs"]["values"] == recorded["runs"]["inputs"]["values"]


def test_rows_one_by_one_add_up_to_all_the_data() -> None:
    one = session()
    one.wish({"do": "step", "ticks": 20})
    rows = [json.loads(row) for row in one.rows]
    data: Any = one.data()
    assert len(rows) == data["ticks"] == 21
    x = [row["tracks"]["robot"][0] for row in rows]
    assert [round(value * 1000) for value in x] == list(_sums(data["tracks"]["robot"]["columns"][0]))
    changes = [n for n, row in enumerate(rows) if "inputs" in row["runs"]]
    assert changes == list(_sums(data["runs"]["inputs"]["at"]))


def _sums(steps: list[int]) -> list[int]:
    return [sum(steps[: k + 1]) for k in range(len(steps))]


def test_a_percept_that_is_forced_decides_until_it_is_taken_back() -> None:
    one = session()
    one.wish({"do": "force", "percept": "anything-is-too-close", "value": True})
    one.wish({"do": "step", "ticks": 1})
    assert note(one)["outputs"]["action"] == "(move-away-from-danger)"
    one.wish({"do": "force", "percept": "(anything-is-too-close)", "value": None})
    one.wish({"do": "step", "ticks": 1})
    assert note(one)["outputs"]["action"] != "(move-away-from-danger)"
    assert one.state()["forced"] == {}


def test_a_thing_that_is_moved_is_there_and_is_sensed() -> None:
    one = session()
    before = one.episode.world.sense().sonar
    one.wish({"do": "move", "thing": "trashcan-1", "pose": [1.2, 0.0, 0.0]})
    one.wish({"do": "step", "ticks": 4})
    after = one.episode.world.sense().sonar
    assert before is not None and after is not None
    assert min(after.ranges) < 0.7 < min(before.ranges) + 0.2
    assert json.loads(one.rows[-1])["tracks"]["mover trashcan-1"][:2] == [1.2, 0.0]


def test_a_thing_cannot_be_put_where_the_robot_stands() -> None:
    one = session()
    thing = next(one for one in one.episode.world.things if one.placed.id == "trashcan-1")
    was = thing.pose
    with pytest.raises(WishError, match="the robot stands where 'trashcan-1' would be"):
        one.move("trashcan-1", Pose(0.1, 0.0, 0.0))
    assert thing.pose == was


def test_it_stops_when_a_rule_begins_to_fire_and_not_again_while_it_does() -> None:
    one = session()
    one.wish({"do": "break", "rule": "(maint runaway)", "on": True})
    one.wish({"do": "step", "ticks": 5})
    assert one.ticks == 6
    one.wish({"do": "force", "percept": "anything-is-too-close", "value": True})
    one.wish({"do": "step", "ticks": 50})
    assert (one.ticks, one.said) == (7, "(maint runaway) fires at 0.6 s")
    one.wish({"do": "step", "ticks": 3})
    assert (one.ticks, one.state()["breaks"]) == (10, ["(maint runaway)"])
    one.wish({"do": "break", "rule": "(maint runaway)", "on": False})
    assert one.state()["breaks"] == []


def test_it_begins_anew_as_it_began() -> None:
    one = session()
    one.wish({"do": "step", "ticks": 10})
    first, number = list(one.rows), one.run_number
    one.wish({"do": "restart"})
    one.wish({"do": "step", "ticks": 10})
    assert (list(one.rows), one.run_number) == (first, number + 1)


def test_when_the_time_is_over_there_are_no_more_ticks() -> None:
    world = load_world(LOT)
    from dataclasses import replace

    short = World(replace(world.scenario, time_limit=0.5), world.text)
    one = Session(compile_file(FIND), short, 0)
    one.wish({"do": "run", "on": True})
    one.wish({"do": "step", "ticks": 50})
    assert (one.ticks, one.over, one.state()["running"]) == (5, "the time is over", False)
    assert not one.step()
    one.wish({"do": "run", "on": True})
    assert (one.wishes.running, one.said) == (False, "the time is over")


def test_a_fault_in_a_percept_ends_the_run_and_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    one = session()

    def fail(_self: PlanBrain, _reading: Reading) -> None:
        raise RuntimeError("no such thing")

    monkeypatch.setattr(PlanBrain, "step", fail)
    one.wish({"do": "step", "ticks": 2})
    assert (one.over, one.ticks) == ("RuntimeError: no such thing", 1)


@pytest.mark.parametrize(
    ("wish", "said"),
    [
        ({"do": "fly"}, "no wish"),
        ("run", "no wish"),
        ({"do": "step", "ticks": 10**9}, "no wish"),
        ({"do": "speed", "to": 1e9}, "no wish"),
        ({"do": "move", "thing": "moon", "pose": [0, 0, 0]}, "there is no thing 'moon'"),
        ({"do": "move", "thing": "wall-1", "pose": [0, 0, 0]}, "'wall-1' cannot be moved by hand"),
        ({"do": "move", "thing": "post-1", "pose": [0, float("nan"), 0]}, "three finite numbers"),
        ({"do": "force", "percept": "weather", "value": True}, "the plan reads no percept (weather)"),
        ({"do": "force", "percept": "there-is-a-goal", "value": 3}, "(there-is-a-goal) is a truth value, not 3"),
        ({"do": "break", "rule": "(ach rest)", "on": True}, "the plan has no rule (ach rest)"),
    ],
)
def test_wishes_that_cannot_be_are_refused_in_words(wish: object, said: str) -> None:
    one = session()
    with pytest.raises(WishError, match=re.escape(said)):
        one.wish(wish)
    assert one.ticks == 1


def test_numbers_are_forced_as_numbers() -> None:
    plan = PLANS / "patrol" / "patrol.rplan"
    compiled = compile_file(plan)
    numbers = [atom.left.name for atom in compiled.ways.atoms if isinstance(atom, Comparison)]
    world = load_world(next(iter(sorted(plan.parent.glob("*.yaml")))))
    one = Session(compiled, world, 0)
    name = numbers[0]
    one.wish({"do": "force", "percept": name, "value": 1})
    assert one.state()["forced"] == {name: 1.0}
    with pytest.raises(WishError, match="is a finite number, not True"):
        one.force(name, True)


# --- the server ------------------------------------------------------------------------------------

Act = Callable[[Viewer], Awaitable[None]]


def served(act: Act, one: Session | None = None) -> Session:
    """Serve a session while something is done with it."""
    watched = one or session()

    async def run() -> None:
        stop = asyncio.Event()

        async def ready(viewer: Viewer) -> None:
            try:
                await asyncio.wait_for(act(viewer), 20)
            finally:
                stop.set()

        await watch(watched, 0, ready, stop)

    asyncio.run(run())
    return watched


def page(viewer: Viewer, origin: str | None = "", path: str = "live") -> connect:
    """A page's connection; origin "": the right one."""
    right = f"http://127.0.0.1:{viewer.port}"
    address = f"ws://127.0.0.1:{viewer.port}/{viewer.token}/{path}"
    given = right if origin == "" else origin
    return connect(address, origin=None if given is None else Origin(given), max_size=None)


async def heard(connection: ClientConnection) -> dict[str, Any]:
    value: dict[str, Any] = json.loads(await connection.recv())
    return value


async def got(viewer: Viewer, path: str, host: str = "", more: str = "") -> tuple[int, str, str]:
    """Status, head and body of a plain request."""
    reader, writer = await asyncio.open_connection("127.0.0.1", viewer.port)
    writer.write(f"GET {path} HTTP/1.1\r\nHost: {host or f'127.0.0.1:{viewer.port}'}\r\n{more}\r\n".encode())
    head, _, body = (await reader.read()).decode().partition("\r\n\r\n")
    writer.close()
    return int(head.split()[1]), head, body


def test_a_page_gets_everything_and_then_each_tick() -> None:
    async def act(viewer: Viewer) -> None:
        async with page(viewer) as connection:
            opened = await heard(connection)
            assert opened["open"]["ticks"] == 1 and opened["open"]["header"]["plan"]["name"] == "find-and-fetch"
            assert opened["fixed"]["percepts"]["there-is-a-goal"] == "truth"
            await connection.send(json.dumps({"do": "step", "ticks": 3}))
            grown = await heard(connection)
            assert [row["t"] for row in grown["grow"]] == [100, 200, 300]

    assert served(act).ticks == 4


def test_it_runs_at_the_speed_that_is_wished_and_stops() -> None:
    async def act(viewer: Viewer) -> None:
        async with page(viewer) as connection:
            await heard(connection)
            await connection.send(json.dumps({"do": "speed", "to": 50}))
            await connection.send(json.dumps({"do": "run", "on": True}))
            rows = 0
            while rows < 60:
                rows += len((await heard(connection)).get("grow", []))
            await connection.send(json.dumps({"do": "run", "on": False}))
            while (await heard(connection))["state"]["running"]:
                pass

    assert served(act).ticks > 60


def test_two_pages_see_the_same_and_one_that_comes_later_sees_all() -> None:
    async def act(viewer: Viewer) -> None:
        async with page(viewer) as first, page(viewer) as second:
            await heard(first), await heard(second)
            await first.send(json.dumps({"do": "step", "ticks": 2}))
            assert await heard(first) == await heard(second)
            async with page(viewer) as third:
                assert (await heard(third))["open"]["ticks"] == 3

    served(act)


def test_a_scenario_that_this_seed_makes_unsound_is_named(tmp_path: Path) -> None:
    full = tmp_path / "full.yaml"
    full.write_text(
        "name: full\nbounds: [-2, -2, 2, 2]\nrobot: {start: [0, 0]}\n"
        "scatter: [{kinds: [person], count: [50, 50], region: [-1, -1, 1, 1], min_gap: 1}]\n",
        encoding="utf-8",
    )
    result = CliRunner().invoke(cli, ["view", str(FIND), "--scenario", str(full), "--seed", "7"])
    assert (result.exit_code, result.stderr[:43]) == (2, "error: full.yaml, seed 7: scatter: no room ")


def test_what_is_refused_is_said_and_changes_nothing() -> None:
    async def act(viewer: Viewer) -> None:
        async with page(viewer) as connection:
            await heard(connection)
            for sent in ("no json", "[" * 5000, '{"do":"fly"}', b"\xff"):
                await connection.send(sent)
                assert "refused" in await heard(connection)

    assert served(act).ticks == 1


def test_nothing_ticks_while_nobody_looks(monkeypatch: pytest.MonkeyPatch) -> None:
    one = session()
    one.wishes.running = True
    paced: list[float] = []

    async def sleep(seconds: float, sleep: Callable[[float], Awaitable[None]] = asyncio.sleep) -> None:
        paced.extend([seconds] * (seconds > 0))
        await sleep(seconds)

    async def act(viewer: Viewer) -> None:
        for _ in range(20):
            await asyncio.sleep(0)
        assert (viewer.session.ticks, paced) == (1, []), "it waits for somebody who looks, and not for the next tick"
        async with page(viewer) as connection:
            await heard(connection)
            await heard(connection)
        assert viewer.session.ticks > 1
        assert paced

    monkeypatch.setattr(asyncio, "sleep", sleep)
    served(act, one)


def test_the_page_stands_alone_and_may_ask_this_server_only() -> None:
    async def act(viewer: Viewer) -> None:
        status, head, body = await got(viewer, f"/{viewer.token}/")
        assert status == 200 and body.startswith("<!doctype html>") and "{{" not in body.partition("<script>")[0]
        policy = re.findall(r"Content-Security-Policy: (.*)", head)[0]
        assert "default-src 'none'" in policy and "frame-ancestors 'none'" in policy
        assert not re.search(r"""(?:src|href)\s*=\s*["']""", body)
        assert viewer.token not in body

    served(act)


def test_without_the_token_there_is_nothing() -> None:
    async def act(viewer: Viewer) -> None:
        for path in ("/", "/live", "/wrong/", f"/{viewer.token[:-1]}/", f"/{viewer.token}/other", f"//{viewer.token}/"):
            assert (await got(viewer, path))[0] == 404
        with pytest.raises(InvalidStatus, match="404"):
            await page(viewer, path="../live")

    served(act)


def test_other_hosts_and_other_origins_are_refused() -> None:
    async def act(viewer: Viewer) -> None:
        here = f"/{viewer.token}/"
        for host in (
            "evil.example",
            f"evil.example:{viewer.port}",
            "127.0.0.1",
            f"127.0.0.1:{viewer.port}.evil.example",
        ):
            assert (await got(viewer, here, host))[0] == 403
        assert (await got(viewer, here, f"localhost:{viewer.port}"))[0] == 200
        assert (await got(viewer, here, more="Origin: http://evil.example\r\n"))[0] == 403
        assert (await got(viewer, here, more=f"Host: localhost:{viewer.port}\r\n"))[0] in (400, 403)
        for origin in (None, "null", "http://evil.example", f"https://127.0.0.1:{viewer.port}", "http://127.0.0.1:1"):
            with pytest.raises(InvalidStatus, match="403"):
                async with page(viewer, origin):
                    pass

    served(act)


def test_it_listens_on_this_machine_alone() -> None:
    async def act(viewer: Viewer) -> None:
        assert viewer.host == "127.0.0.1"

    served(act)


def test_no_more_than_eight_pages_look() -> None:
    async def act(viewer: Viewer) -> None:
        pages = [await page(viewer) for _ in range(8)]
        with pytest.raises(InvalidStatus, match="503"):
            await page(viewer)
        for one in pages:
            await one.close()

    served(act)


def test_a_connection_that_breaks_ends_nothing_and_the_next_one_gets_all() -> None:
    async def act(viewer: Viewer) -> None:
        async with page(viewer) as connection:
            await heard(connection)
            await connection.send(json.dumps({"do": "step", "ticks": 3}))
            await heard(connection)
            await connection.send(json.dumps({"do": "force", "percept": "there-is-a-goal", "value": True}))
            await heard(connection)
            connection.transport.abort()
        async with page(viewer) as connection:
            opened = await heard(connection)
            assert (opened["open"]["ticks"], opened["state"]["forced"]) == (4, {"there-is-a-goal": True})
            await connection.send(json.dumps({"do": "step", "ticks": 1}))
            assert [row["t"] for row in (await heard(connection))["grow"]] == [400]

    assert served(act).ticks == 5


def test_only_the_end_of_the_server_is_told_as_its_end() -> None:
    async def act(viewer: Viewer) -> None:
        connections.append(await page(viewer))
        await heard(connections[0])

    async def told() -> int | None:
        stop = asyncio.Event()

        async def ready(viewer: Viewer) -> None:
            await act(viewer)
            stop.set()

        await watch(session(), 0, ready, stop)
        await connections[0].wait_closed()
        return connections[0].close_code

    connections: list[ClientConnection] = []
    assert asyncio.run(told()) == 1001
    script = (ROOT / "rplan" / "apps" / "viewer" / "live.js").read_text(encoding="utf-8")
    assert "e.code === 1001 ? ended() : lost()" in script


def test_addresses_differ_from_run_to_run() -> None:
    tokens: list[str] = []

    async def act(viewer: Viewer) -> None:
        tokens.append(viewer.token)
        assert viewer.address == f"http://127.0.0.1:{viewer.port}/{viewer.token}/"

    for _ in range(2):
        served(act)
    assert tokens[0] != tokens[1] and min(map(len, tokens)) >= 24


def test_a_page_that_lags_too_far_behind_gets_everything_anew() -> None:
    async def act(viewer: Viewer) -> None:
        async with page(viewer) as connection:
            await heard(connection)
            viewer.session.step()
            viewer.session.rows.clear()
            await connection.send(json.dumps({"do": "speed", "to": 2}))
            assert (await heard(connection))["open"]["ticks"] == 2

    served(act)


# --- the command -----------------------------------------------------------------------------------


def test_without_websockets_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(view, "find_spec", lambda name: None)
    result = CliRunner().invoke(cli, ["view", str(FIND)])
    assert (result.exit_code, result.stderr) == (2, "error: rplan view needs websockets: pip install 'rplan[view]'\n")


def test_wrong_worlds_and_ports_are_said(tmp_path: Path) -> None:
    wrong, robot = tmp_path / "wrong.yaml", tmp_path / "crowded.yaml"
    wrong.write_text("name: x\n", encoding="utf-8")
    robot.write_text(
        "name: crowded\nbounds: [-2, -2, 2, 2]\nrobot: {start: [0, 0], heading: 0}\n"
        "things: [{kind: post, at: [0.1, 0]}]\n",
        encoding="utf-8",
    )
    picture = tmp_path / "map.yaml"
    picture.write_text("image: none.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n", encoding="utf-8")
    cases = [
        (picture, "occupied_thresh: this key is missing"),
        (wrong, "the scenario is wrong"),
        (robot, "the robot stands in"),
        (tmp_path / "no.yaml", "there is no scenario"),
    ]
    for path, said in cases:
        result = CliRunner().invoke(cli, ["view", str(FIND), "--scenario", str(path)])
        assert result.exit_code == 2 and said in result.stderr, result.stderr
    unbound = tmp_path / "standing.rplan"
    unbound.write_text(STANDING, encoding="utf-8")
    result = CliRunner().invoke(cli, ["view", str(unbound), "--scenario", str(LOT)])
    assert result.exit_code == 1 and "nothing brings `(heard)` to life" in result.stderr


def test_a_port_that_is_taken_is_said() -> None:
    import socket

    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        result = CliRunner().invoke(cli, ["view", str(FIND), "--port", str(port)])
    assert result.exit_code == 2 and f"port {port} of 127.0.0.1" in result.stderr


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_ctrl_c_or_a_closed_terminal_ends_it_cleanly(number: signal.Signals) -> None:
    process = subprocess.Popen(
        [sys.executable, "-u", "-c", "from rplan.apps.cli import main; main()", "view", str(FIND), "--paused"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )
    assert process.stdout is not None
    assert process.stdout.readline().startswith("watch it at http://127.0.0.1:")
    process.send_signal(number)
    out, error = process.communicate(timeout=20)
    assert (process.returncode, out, error) == (0, "ended at 0.1 s of simulated time\n", "")


def test_a_plan_without_rules_can_be_watched() -> None:
    plan = "(plan p :period 0.1s)\n(use robot)\n(defoutput action command :idle (stop))\n(goalem (do action (stop)))\n"
    one = Session(compile_source(Source("p.rplan", plan)), load_world(LOT), 0)
    one.wish({"do": "step", "ticks": 2})
    assert (one.ticks, one.fixed()["rules"], one.fixed()["percepts"]) == (3, [], {})
