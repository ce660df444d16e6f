"""A plan of 200 rules: what `rplan inspect` writes of it, and its runs, can be read.

Takes: a browser and a folder. Gives: points. Leaves alone: whether what is told is right; the tests ask that.
"""

from __future__ import annotations

from pathlib import Path

from viewer.chromium import Tab
from viewer.points import ROOT, Points, rplan

RULES, WIDEST = 200, 200
FETCH = ROOT / "plans" / "find_and_fetch" / "find_and_fetch.rplan"
OVERLAPS = """(() => {
  const boxes = [...document.querySelectorAll('text')].map(t => [t.getBoundingClientRect(), t.textContent]), all = [];
  const flat = [...document.querySelectorAll('text')].map(t => !t.closest('[transform]'));
  const page = document.documentElement.getBoundingClientRect();
  boxes.forEach(([a, words], k) => {
    if (a.left < page.left - 1 || a.right > page.right + 1 || a.bottom > page.bottom + 1) all.push('cut off: ' + words);
    if (!flat[k]) return;
    for (let j = k + 1; j < boxes.length; j++) {
      const b = boxes[j][0];
      if (flat[j] && a.left < b.right - 2 && b.left < a.right - 2 && a.top < b.bottom - 4 && b.top < a.bottom - 4) all.push(words + ' over ' + boxes[j][1]);
    }
  });
  return all;
})()"""
SHOWN = "[...document.querySelectorAll('{}')].filter(n => n.offsetParent && n.checkVisibility()).length"


def plan_text(rules: int) -> str:
    """Find and fetch with so many rules that each report something beside it."""
    text = FETCH.read_text(encoding="utf-8")
    head, goal = text[: text.index("(defgoalr")], text[text.index("(defgoalr") :]
    own = goal.count("(defgoalr")
    percepts = ["there-is-a-goal", "we-are-at-the-goal", "donor-has-been-located", "anything-is-too-close"]
    names = [f"report-{k:03}" for k in range(rules - own)]
    outputs = "".join(f"(defoutput {name} bool :idle false)\n" for name in names)
    bodies = "".join(
        f"(defgoalr (ach {name})\n  (if (and ({percepts[k % 4]}) (not ({percepts[(k + 1 + k // 7 % 3) % 4]})))\n"
        f"      (do {name} true)\n      (do anything)))\n\n"
        for k, name in enumerate(names)
    )
    top = goal.rindex("(ach move-to-goal)")
    more = "".join(f"\n                  (ach {name})" for name in names)
    top += len("(ach move-to-goal)")
    body = goal[: goal.index("(goalem")], goal[goal.index("(goalem") : top]
    return f"{head}{outputs}\n{body[0]}{bodies}{body[1]}{more}{goal[top:]}"


async def inspects(tab: Tab, points: Points, folder: Path) -> Path:
    """Text, drawings, page; gives the plan's file."""
    plan = folder / "two_hundred.rplan"
    plan.write_text(plan_text(RULES), encoding="utf-8")
    await _text(points, plan)
    await _drawings(tab, points, plan)
    page = plan.with_suffix(".inspect.html")
    await rplan("inspect", str(plan), "--html", str(page))
    await tab.open(page.as_uri())
    await _searched(tab, points)
    await _folded(tab, points)
    points.add("i", "the page makes the console complain of nothing", not tab.complaints, tab.complaints or "none")
    return plan


async def _text(points: Points, plan: Path) -> None:
    said = await rplan("inspect", str(plan))
    lines = said.splitlines()
    widest = max(map(len, lines))
    named = all(f"(ach report-{k:03})" in said for k in range(RULES - 7))
    seen = f"{len(lines):,} lines, the widest has {widest} letters"
    points.add("i", "as text: each rule is there, no line too wide", named and widest <= WIDEST, seen)


async def _drawings(tab: Tab, points: Points, plan: Path) -> None:
    for part in ("goals", "table", "percepts"):
        drawing = plan.with_suffix(f".{part}.svg")
        await rplan("inspect", str(plan), f"--{part}", "--svg", str(drawing))
        await tab.call("Page.navigate", url=drawing.as_uri())
        await tab.until("document.readyState === 'complete' && !!document.querySelector('text')")
        faults, texts = await tab.eval(OVERLAPS), await tab.eval("document.querySelectorAll('text').length")
        said = f"{len(faults)}: {faults[:3]}" if faults else f"{texts} texts"
        points.add("i", f"--{part} --svg: no text over another or cut off", not faults and texts > RULES, said)


async def _searched(tab: Tab, points: Points) -> None:
    rows, places = "#table tr.hit", "#goals .place"
    every = [await tab.eval(SHOWN.format(one)) for one in (rows, places)]
    await tab.key("/")
    for letter in "report-123":
        await tab.key(letter)
    found = [await tab.eval(SHOWN.format(one)) for one in (rows, places)]
    marked, said = await tab.eval(SHOWN.format(".found")), await tab.eval("document.getElementById('count').textContent")
    met = marked > 3 and 0 < found[0] < 10 and 0 < found[1] < 20 and every[0] > 100
    points.add("i", "the page: a search for report-123 leaves its rows and places", met, f"{every} -> {found}, {said}")
    seen = "(n => n.getBoundingClientRect().top < innerHeight && n.getBoundingClientRect().bottom > 0)"
    first = await tab.eval(f"{seen}(document.querySelector('tr.found'))")
    points.add("i", "and its first row is in sight", first)
    await tab.key("Escape")
    again = [await tab.eval(SHOWN.format(one)) for one in (rows, places)]
    points.add("i", "Escape shows all again", again[0] == every[0] and not await tab.eval(SHOWN.format(".found")), again)


async def _folded(tab: Tab, points: Points) -> None:
    counts = []
    for button in ("#unfold", "#fold"):
        await tab.click(button)
        counts.append(await tab.eval(SHOWN.format("#goals .place")))
    rule = "#goals details details > summary"
    await tab.click(f"{rule}:has(.rule)", 0.01)
    counts.append(await tab.eval(SHOWN.format("#goals .place")))
    met = counts[0] > 3 * RULES > counts[1] and counts[2] > counts[1]
    points.add("i", "folds: all, none, and one rule by a click", met, f"{counts} places in sight")
