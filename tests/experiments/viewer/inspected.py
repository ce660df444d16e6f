"""A plan of 200 rules: what `rplan inspect` writes of it, and its runs, can be read.

Takes: a browser and a folder. Gives: points. Leaves alone: whether what is told is right; the tests ask that.
"""

from __future__ import annotations

from pathlib import Path

from viewer.chromium import Tab
from viewer.points import ROOT, Points, rplan

RULES, WIDEST = 200, 120
FETCH = ROOT / "plans" / "find_and_fetch" / "find_and_fetch.rplan"
HOSTILE = "; </script><img src=x onerror=alert(1)> <!-- {{data}}\n"
"""What a plan says in a comment must stay a comment."""
OVERLAPS = """(() => {
  const boxes = [...document.querySelectorAll('text')].map(t => [t.getBoundingClientRect(), t.textContent]), all = [];
  const flat = [...document.querySelectorAll('text')].map(t => !t.closest('[transform]'));
  const page = document.documentElement.getBoundingClientRect();
  const beside = (a, b) => a.left >= b.right - 2 || a.top >= b.bottom - 4;
  const aside = (a, b) => beside(a, b) || beside(b, a);
  boxes.forEach(([a, words], k) => {
    const out = a.left < page.left - 1 || a.right > page.right + 1 || a.bottom > page.bottom + 1;
    if (out) all.push('cut off: ' + words);
    for (let j = k + 1; flat[k] && j < boxes.length; j++)
      if (flat[j] && !aside(a, boxes[j][0])) all.push(words + ' over ' + boxes[j][1]);
  });
  return all;
})()"""
ENDS = "))\n"
SHOWN = "[...document.querySelectorAll('{}')].filter(n => n.offsetParent && n.checkVisibility()).length"


def reporting(rules: int) -> str:
    """Find and fetch with so many rules; those beside its own each report something to whoever listens."""
    text = FETCH.read_text(encoding="utf-8")
    head, goal = text[: text.index("(defgoalr")], text[text.index("(defgoalr") :]
    percepts = ["there-is-a-goal", "we-are-at-the-goal", "donor-has-been-located", "anything-is-too-close"]
    names = [f"report-{k:03}" for k in range(rules - goal.count("(defgoalr"))]
    outputs = "".join(f"(defoutput {name} bool :idle false)\n" for name in names)
    bodies = "".join(
        f"(defgoalr (ach {name})\n  (if (and ({percepts[k % 4]}) (not ({percepts[(k + 1 + k // 7 % 3) % 4]})))\n"
        f"      (do {name} true)\n      (do anything)))\n\n"
        for k, name in enumerate(names)
    )
    more = "".join(f"\n                  (ach {name})" for name in names)
    return f"{head}{HOSTILE}{outputs}\n{goal.replace('(goalem', f'{bodies}(goalem').removesuffix(ENDS)}{more}{ENDS}"


def tangled(rules: int) -> str:
    """A plan of so many rules for one output, with more conditions than a table can have columns."""
    heads = [f"(ach report-{k:03})" for k in range(rules)]
    bodies = [
        f"(defgoalr {head}\n  (if (and (near-{k:03}) (kind-{k % 17})) (do action (say-{k:03})) (do anything)))\n"
        for k, head in enumerate(heads)
    ]
    top = "\n                  ".join(heads)
    return f"(plan tangled)\n(defoutput action command :idle (stop))\n\n{''.join(bodies)}(goalem (prio-and {top}))\n"


async def inspects(tab: Tab, points: Points, folder: Path, name: str) -> Path:
    """Text, drawings and page of one of the plans; gives the page."""
    plan = folder / f"{name}.rplan"
    plan.write_text(PLANS[name](RULES), encoding="utf-8")
    await _text(points, plan)
    await _drawings(tab, points, plan)
    page = plan.with_suffix(".inspect.html")
    await rplan("inspect", str(plan), "--html", str(page))
    await tab.open(page.as_uri())
    await _searched(tab, points, plan.stem)
    await _folded(tab, points, plan.stem)
    points.add("i", f"{name}: the console has no complaint", not tab.complaints, tab.complaints or "none")
    return page


async def _text(points: Points, plan: Path) -> None:
    said = await rplan("inspect", str(plan))
    lines = said.splitlines()
    widest = max(map(len, lines))
    named = all(f"(ach report-{k:03})" in said for k in range(RULES - 10))
    seen = f"{len(lines):,} lines, the widest has {widest} letters"
    points.add("i", f"{plan.stem} as text: each rule is there, no line too wide", named and widest <= WIDEST, seen)


async def _drawings(tab: Tab, points: Points, plan: Path) -> None:
    for part in ("goals", "table", "percepts"):
        drawing = plan.with_suffix(f".{part}.svg")
        await rplan("inspect", str(plan), f"--{part}", "--svg", str(drawing))
        await tab.call("Page.navigate", url=drawing.as_uri())
        await tab.until("document.readyState === 'complete' && !!document.querySelector('text')")
        faults, texts = await tab.eval(OVERLAPS), await tab.eval("document.querySelectorAll('text').length")
        said = f"{len(faults)}: {faults[:3]}" if faults else f"{texts} texts"
        points.add("i", f"{plan.stem} --{part} --svg: no text over another or cut off", not faults and texts > 40, said)


async def _searched(tab: Tab, points: Points, name: str) -> None:
    rows, places = "#table tr.hit", "#goals .place"
    every = [await tab.eval(SHOWN.format(one)) for one in (rows, places)]
    await tab.key("/")
    for letter in "report-123":
        await tab.key(letter)
    found = [await tab.eval(SHOWN.format(one)) for one in (rows, places)]
    marked, said = (
        await tab.eval(SHOWN.format(".found")),
        await tab.eval("document.getElementById('count').textContent"),
    )
    met = marked >= 3 and 0 < found[0] < 10 and 0 < found[1] < 20 and every[0] > 30
    points.add(
        "i", f"{name}, its page: a search for report-123 leaves its rows and places", met, f"{every} -> {found}, {said}"
    )
    seen = "(n => n.getBoundingClientRect().top < innerHeight && n.getBoundingClientRect().bottom > 0)"
    first = await tab.eval(f"{seen}(document.querySelector('tr.found'))")
    points.add("i", f"{name}: and its first row is in sight", first)
    await tab.key("Escape")
    again = [await tab.eval(SHOWN.format(one)) for one in (rows, places)]
    points.add(
        "i",
        f"{name}: Escape shows all again",
        again[0] == every[0] and not await tab.eval(SHOWN.format(".found")),
        again,
    )


async def _folded(tab: Tab, points: Points, name: str) -> None:
    counts = []
    for button in ("#unfold", "#fold"):
        await tab.click(button)
        counts.append(await tab.eval(SHOWN.format("#goals .place")))
    rule = "#goals details details > summary"
    await tab.click(f"{rule}:has(.rule)", 0.01)
    counts.append(await tab.eval(SHOWN.format("#goals .place")))
    met = counts[0] > 3 * RULES > counts[1] and counts[2] > counts[1]
    points.add("i", f"{name}: folds all, none, one rule by a click", met, f"{counts} places in sight")


async def viewed(tab: Tab, points: Points, page: Path) -> None:
    """The page of a run of `reporting`: what has 200 rules is folded, and can be searched."""
    await tab.open(page.as_uri())
    await tab.click("#timeline", 0.7)
    places = [await tab.eval(SHOWN.format(one)) for one in ("#rules .rule", "#losers p")]
    folds = await tab.eval("[...document.querySelectorAll('#reasons summary')].map(s => s.textContent)")
    points.add("i", "a run of it: few rules and losers, the others folded", max(places) < 30 and len(folds) > 1,
               f"{places} in sight; {folds}")  # fmt: skip
    await tab.click("#losers summary")
    more = await tab.eval(SHOWN.format("#losers p"))
    await tab.key("ArrowRight")
    kept = await tab.eval(SHOWN.format("#losers p"))
    points.add("i", "a run of it: a fold opens, and stays so when time goes on", more > places[1] and kept >= more - 5,
               f"{places[1]} -> {more} -> {kept} losers")  # fmt: skip
    await tab.key("/")
    for letter in "report-150":
        await tab.key(letter)
    hits = await tab.eval("document.getElementById('hits').textContent")
    lines = await tab.eval("[...document.querySelectorAll('#code .found')].length")
    left = await tab.eval(SHOWN.format("#rules .rule")) + await tab.eval(SHOWN.format("#losers p"))
    await tab.key("Enter")
    seen = await tab.eval("""(() => { const box = document.getElementById('code').getBoundingClientRect();
        const line = document.querySelectorAll('#code .found')[1].getBoundingClientRect();
        return line.top >= box.top && line.bottom <= box.bottom; })()""")
    met = lines == 4 and hits.startswith("1 of 4") and seen and 0 < left < 4
    points.add("i", "a run of it: / finds lines, rules and goals; Enter shows the next", met, f"{hits}; {left} rules")
    strangers = await tab.eval("document.querySelectorAll('img').length")
    said = await tab.eval("document.getElementById('code').textContent.includes('onerror=alert')")
    safe = said and not strangers and not tab.complaints
    points.add("i", "a run of it: a hostile comment stays text; no complaint", safe, tab.complaints or "none")


PLANS = {"reporting": reporting, "tangled": tangled}
