"""A plan of 200 rules whose circuit is too large to be drawn whole: parts of it are, and their wires are live.

Takes: a browser and a folder. Gives: points. Leaves alone: small circuits, which are drawn whole.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from pathlib import Path
from statistics import median
from typing import Any, cast

from viewer.chromium import WIDE, Tab
from viewer.frames import BUDGET_MS, OPEN_MS, STOPWATCH
from viewer.inspected import FETCH, RULES
from viewer.points import ROOT, Points, rplan
from viewer.replayed import now

from rplan.apps.drawing.inspect_circuit_part import choice, part
from rplan.apps.wiring import compile_file
from rplan.circuit.cell import Op
from rplan.circuit.circuit import Circuit
from sim.recording import read

SEED, UNTIL, LEAST, MOST = 3, 120, 1800, 300
"""The run, the gates that the plan has at least, and those that a drawing has at most unless more are asked for."""
PAGE = 100
"""Gates that the page shows at first."""
SCENARIO = ROOT / "plans" / "find_and_fetch" / "parking_lot.yaml"
SAID = "document.querySelector('.part .said').textContent"
GATES = "document.querySelectorAll('.part .cell > path.gate').length"
LIT = """[...document.querySelectorAll('.part [data-net]')]
    .map(g => [Number(g.dataset.net), g.classList.contains('on')])"""
NUMBERS = "[...document.querySelectorAll('.part .cell:has(> path.gate)')].map(g => Number(g.dataset.net))"
STUB = """(() => { const paper = document.querySelector('.part .paper'), inside = paper.getBoundingClientRect();
    for (const stub of document.querySelectorAll('.part .cell.stub > circle')) {
      stub.scrollIntoView({block: 'center', inline: 'center'}); const b = stub.getBoundingClientRect();
      return [b.left + b.width / 2, b.top + b.height / 2, Number(stub.parentNode.dataset.net)]; } })()"""


def remembering(rules: int) -> str:
    """Find and fetch with so many rules; those beside its own ask for how long something held, and what was before."""
    text = FETCH.read_text(encoding="utf-8")
    head, goal = text[: text.index("(defgoalr")], text[text.index("(defgoalr") :]
    percepts = ["there-is-a-goal", "we-are-at-the-goal", "donor-has-been-located", "anything-is-too-close"]
    names = [f"report-{k:03}" for k in range(rules - goal.count("(defgoalr"))]
    outputs = "".join(f"(defoutput {name} bool :idle false)\n" for name in names)
    bodies = "".join(
        f"(defgoalr (ach {name})\n  (if (or (held-for {k % 60 / 10 + 0.2:.1f}s ({percepts[k % 4]}))\n"
        f"          (latch ({percepts[(k + 1) % 4]}) (held-for {k % 80 / 10 + 0.3:.1f}s ({percepts[(k + 2) % 4]}))))\n"
        f"      (do {name} true)\n      (do anything)))\n\n"
        for k, name in enumerate(names)
    )
    more = "".join(f"\n                  (ach {name})" for name in names)
    return f"{head}{outputs}\n{goal.replace('(goalem', f'{bodies}(goalem').removesuffix('))' + chr(10))}{more}))\n"


async def large(tab: Tab, points: Points, work: Path) -> Path:
    """Its page of `rplan inspect` and that of a run; gives the latter."""
    plan = work / "large.rplan"
    plan.write_text(remembering(RULES), encoding="utf-8")
    circuit = compile_file(plan).circuit
    gates = sum(1 for cell in circuit.cells if cell.operands)
    page = work / "large.inspect.html"
    await rplan("inspect", str(plan), "--html", str(page))
    await tab.open(page.as_uri())
    said, drawn = await tab.eval(SAID), await tab.eval(GATES)
    points.add("l", "inspect draws a part and says how many gates of how many", _says(said, drawn, gates), said)
    run, page = await _run(plan)
    await _opens(tab, points, page, gates)
    await _searched(tab, points)
    await _cut(tab, points, circuit)
    await _followed(tab, points)
    await _live(tab, points, run, circuit)
    await _plays(tab, points, page)
    points.add("l", "and nothing of it made the console complain", not tab.complaints, tab.complaints or "none")
    return page


async def _run(plan: Path) -> tuple[Path, Path]:
    """Its first two minutes, at whose end nothing is fetched yet."""
    run = plan.with_suffix(".mcap")
    with suppress(RuntimeError):
        await rplan("simulate", str(plan), "--seed", str(SEED), "--scenario", str(SCENARIO), "--until", str(UNTIL),
                    "--record", str(run))  # fmt: skip
    await rplan("replay", str(run), "-o", str(run.with_suffix(".html")))
    return run, run.with_suffix(".html")


def _says(said: str, drawn: int, gates: int) -> bool:
    return gates > LEAST and 0 < drawn <= MOST and said.startswith(f"{drawn} of {gates:,} gates: what makes ")


async def _opens(tab: Tab, points: Points, page: Path, gates: int) -> None:
    await tab.size(WIDE)
    await tab.open(f"{page.as_uri()}#tab=circuit")
    ready = float(await tab.eval("performance.now()"))
    said, drawn = await tab.eval(SAID), await tab.eval(GATES)
    size = page.stat().st_size / 1e6
    met = _says(said, drawn, gates) and "action=(" in said and ready < OPEN_MS
    points.add("l", "a run opens within 2 s at its circuit: what makes the action", met,
               f"{ready:.0f} ms, {size:.1f} MB; {said}")  # fmt: skip


async def _sought(tab: Tab, wanted: str) -> str:
    await tab.key("/")
    for letter in wanted:
        await tab.key(letter)
    await tab.key("Enter")
    return str(await tab.eval(SAID))


async def _searched(tab: Tab, points: Points) -> None:
    for wanted, told in (
        ("report-123", "what makes report-123=true"),
        ("anything-is-too-close", "what reads (anything-is-too-close)"),
        ("gate 1500", "what makes gate 1500"),
    ):
        said, drawn = await _sought(tab, wanted), await tab.eval(GATES)
        points.add("l", f"/ finds {wanted}", told in said and 0 < drawn <= MOST, said)


async def _cut(tab: Tab, points: Points, circuit: Circuit) -> None:
    """The page takes the gates that the command would."""
    faults, seen = list[str](), 0
    for wanted in ("action", "anything-is-too-close", "report-150=true", "gate 1500"):
        await _sought(tab, wanted)
        found = part(circuit, choice(circuit, wanted), PAGE)
        ours = [net for net, cell in zip(found.numbers, found.circuit.cells, strict=True) if cell.operands]
        theirs = sorted(await tab.eval(NUMBERS))
        seen += len(theirs)
        faults += [] if ours == theirs else [f"{wanted}: {len(ours)}, not {len(theirs)}"]
    points.add("l", "a part has the gates that `rplan inspect --of` takes", not faults and seen > PAGE, faults or seen)


async def _followed(tab: Tab, points: Points) -> None:
    await _sought(tab, "report-150=true")
    for _ in range(2):
        await tab.click(".part .pair button")
    few, before = await tab.eval(GATES), await tab.eval(SAID)
    x, y, net = await tab.eval(STUB)
    await tab.press((x, y))
    said = await tab.eval(SAID)
    points.add("l", "a click on a cut wire goes on from there", few == 25 and f"what makes gate {net}" in said, said)
    await tab.click(".part .bar button")
    again = await tab.eval(SAID)
    points.add("l", "and back leads back", again == before, again)


async def _live(tab: Tab, points: Points, run: Path, circuit: Circuit) -> None:
    """Every wire that is drawn has the value that the recorded tick gives it."""
    every = list(read(run).ticks)
    faults, seen, lit = list[str](), 0, 0
    for wanted in ("action", "report-150=true", "gate 1500"):
        await _sought(tab, wanted)
        for share in (0.02, 0.5, 0.86):
            await tab.click("#timeline", share)
            at = await now(tab)
            values = _values(circuit, min(every, key=lambda tick: abs(cast(float, tick["t"]) - at)))
            shown = await tab.eval(LIT)
            faults += [f"net {net} at {at} s" for net, on in shown if on is not values[net]]
            seen, lit = seen + len(shown), lit + sum(on for _, on in shown)
    points.add("l", "every wire has the recorded value of its tick", not faults and 50 < lit < seen,
               faults[:3] or f"{lit} of {seen} lit")  # fmt: skip


def _values(circuit: Circuit, tick: Any) -> list[bool]:
    plan, nets = tick["plan"], list[bool]()
    bits = {Op.INPUT: plan["inputs"], Op.REGISTER: plan["registers"]}
    for cell in circuit.cells:
        if cell.operands:
            nets.append(cell.op.meaning(tuple(nets[one] for one in cell.operands)))
        else:
            nets.append(bits[cell.op][cell.index] == "1" if cell.op in bits else bool(cell.index))
    return nets


async def _plays(tab: Tab, points: Points, page: Path) -> None:
    hook = (await tab.call("Page.addScriptToEvaluateOnNewDocument", source=STOPWATCH))["identifier"]
    await tab.call("Page.navigate", url="about:blank")
    await tab.open(f"{page.as_uri()}#tab=circuit")
    await _sought(tab, "anything-is-too-close")
    await tab.click("#speeds [data-speed='10']")
    costs = []
    for _ in range(3):
        await tab.click("#timeline", 0.5)
        await tab.eval("frames_seen.length = 0")
        await tab.key(" ")
        await asyncio.sleep(3)
        await tab.key(" ")
        costs.append(median([painted - began for began, _, painted in await tab.eval("frames_seen")]))
        if costs[-1] < BUDGET_MS:
            break
    drawn = await tab.eval(GATES)
    points.add("l", f"with {drawn} gates in sight a frame at 10x costs less than {BUDGET_MS:.0f} ms",
               min(costs) < BUDGET_MS, f"{min(costs):.1f} ms")  # fmt: skip
    await tab.call("Page.removeScriptToEvaluateOnNewDocument", identifier=hook)
