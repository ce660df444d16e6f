"""What only some runs have: included files, several outputs, a place to go round.

Takes: a browser and a folder. Gives: points. Leaves alone: what every run's page shows.
"""

from __future__ import annotations

from pathlib import Path

from viewer.chromium import Tab
from viewer.points import Points, recorded
from viewer.replayed import now

INCLUDED = """(() => {
  const nodes = [...document.querySelector('#code').children], from = nodes.findIndex(n => n.className === 'file');
  const after = from < 0 ? [] : nodes.slice(from + 1), count = of => after.filter(n => n.matches(of)).length;
  return {lit: count('.lit'), act: count('.act'), asked: after.filter(n => n.querySelector('b')).length};
})()"""
VALUES = """(() => {
  const lamps = Object.fromEntries([...document.querySelectorAll('.lamp')].map(n =>
    [n.title.split(': jump')[0], n.classList.contains('on')]));
  const marks = [...document.querySelectorAll('#code u')];
  return [marks.length, marks.filter(u => (u.className === 'yes') !== lamps[u.textContent]).length];
})()"""
READOUT = "document.getElementById('readout').innerText.replace(/\\s+/g, ' ')"
TRACKS = "document.querySelector('#tracks canvas').clientHeight / 10"
ROW = """(title => { const c = document.querySelector('#tracks canvas'), b = c.getBoundingClientRect();
  c.dispatchEvent(new PointerEvent('pointermove', {clientX: b.left + 5, clientY: b.top + 5})); return c.title; })()"""


async def others(tab: Tab, points: Points, work: Path) -> None:
    """All of it."""
    _, page = await recorded(work, "plans/fetch_all", 0)
    await includes(tab, points, page)
    _, page = await recorded(work, "plans/perimeter", 0, "--scenario", "perimeter/worlds/bare")
    await goes_round(tab, points, page)


async def includes(tab: Tab, points: Points, page: Path) -> None:
    """The rules of an included file are there, lit, with the values of their conditions."""
    await tab.open(f"{page.as_uri()}#t=200")
    seen = await tab.eval(INCLUDED)
    points.add("i", "what acts in an included file is lit there", all(seen.values()), seen)
    count, wrong = await tab.eval(VALUES)
    points.add("i", "each condition in the text has its value", count > 8 and not wrong, f"{count} marks")


async def goes_round(tab: Tab, points: Points, page: Path) -> None:
    """How far it has gone round, and outputs beside the main one over time."""
    await tab.open(f"{page.as_uri()}#t=0")
    start = await tab.eval(READOUT)
    await tab.key("End")
    at, end = await now(tab), await tab.eval(READOUT)
    turned = float(end.rpartition("round")[2].split(" of ")[0])
    points.add("i", "says how far it has gone round", "round0.00 of 1 turn" in start and turned > 0.9,
               f"{turned:.2f} of 1 turn after {at:.1f} s")  # fmt: skip
    rows, first = await tab.eval(TRACKS), await tab.eval(ROW)
    points.add("i", "outputs and their values over time", rows >= 2 and ":= (follow-perimeter)" in first, first)
