"""A page for each paper: tables, plots and a picture of one run a row.

Takes: results, a folder. Gives: `experiments/PAPER.md`, `experiments/PAPER.csv` (a line an episode) and
`pictures/reproduce/*.png` below the folder; the same results give the same text. Leaves alone: running the experiments,
except the one run of each row that is drawn.

Needs matplotlib, which comes with the extra `rplan[plot]`.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

from rplan.apps.reproduce.figures import case_of, numbers, spread
from rplan.apps.reproduce.report import Result, preset_of, see
from rplan.apps.reproduce.row import Case, Finding, Measures, Plot
from rplan.apps.reproduce.showing import Shown, draw_maps, picture, seen

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TITLES: Mapping[str, str] = {
    "find-and-fetch": "Find and fetch (Bonasso, Antonisse and Slack 1992)",
    "wall-following": "Wall following (Bayer 2012)",
    "wayfarer": "Perimeter reconnaissance (Yamauchi 2005)",
}
MARKS = {"met": "met", "close": "**close**", "missed": "**missed**"}
COLOURS = ("#3478e5", "#b0478f", "#16876f", "#a9720a", "#8457d8", "#8d5a3b", "#5c7f1c", "#0f7fa3")
BAND, INK = "#dcefe4", "#19202b"
UNMEASURED = ("row", "preset", "case", "seed", "scenario", "error", "wall")
MOST_CASES = 8
"""Cases that have a curve, and a line of the table, each; more are taken together by kind."""


def write(every: Sequence[Result], seeds: int, folder: Path) -> Iterator[Path]:
    """Write a page for each paper, and say each file once it stands. Raises OSError."""
    pages, pictures = folder / "experiments", folder / "pictures" / "reproduce"
    pages.mkdir(parents=True, exist_ok=True)
    pictures.mkdir(parents=True, exist_ok=True)
    for paper, some in groupby(every, key=lambda result: result.asked.row.paper):
        found = list(some)
        drawn: dict[str, list[tuple[str, str]]] = {}
        for result in found:
            drawn[_key(result)] = []
            for path, words in _draw(result, pictures):
                drawn[_key(result)].append((f"../pictures/reproduce/{path.name}", words))
                yield path
        table = pages / f"{paper}.csv"
        _write_csv(table, found)
        yield table
        page = pages / f"{paper}.md"
        page.write_text(text(paper, found, seeds, drawn), encoding="utf-8")
        yield page


def _key(result: Result) -> str:
    return f"{result.asked.row.name.lower()}-{result.asked.preset}"


# --- the text -----------------------------------------------------------------------------------------


def text(paper: str, every: Sequence[Result], seeds: int, drawn: Mapping[str, Sequence[tuple[str, str]]]) -> str:
    """The page as Markdown. drawn: for each row and preset its pictures, each with words."""
    counts = [f.judgement for result in every for f in result.findings]
    parts = [
        f"# {TITLES.get(paper, paper)}, run again\n",
        f"```sh\nrplan reproduce {paper} --seeds {seeds} --write docs\n```\n",
        f"{len(counts)} figures of the paper: {counts.count('met')} met, {counts.count('close')} close (within a "
        f"tenth), {counts.count('missed')} missed. Spreads are median (least to most, n = episodes). Seeds are fixed: "
        f"the command gives the same figures again; [{paper}.csv]({paper}.csv) has a line for every episode. "
        "How a row is run and judged stands in `rplan/apps/reproduce/rows/`, and "
        "[the how-to](../how-to/reproduce_a_paper.md) says how to look at one run or add a row.\n",
        _overview(every),
    ]
    for name, some in groupby(every, key=lambda result: result.asked.row.name):
        parts.append(_section(name, list(some), drawn))
    return "\n".join(parts)


def _overview(every: Sequence[Result]) -> str:
    lines = ["| row | preset | figure | paper | ours | verdict |", "| --- | --- | --- | --- | --- | --- |"]
    for result in every:
        for f in result.findings:
            name = result.asked.row.name
            cells = (f"[{name}](#{_anchor(result)})", preset_of(result), f.what, f.printed, f.ours, MARKS[f.judgement])
            lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _heading(result: Result) -> str:
    return f"{result.asked.row.name}: {result.asked.row.title}"


def _anchor(result: Result) -> str:
    kept = "".join(letter for letter in _heading(result).lower() if letter.isalnum() or letter in " -")
    return kept.replace(" ", "-")


def _section(name: str, some: Sequence[Result], drawn: Mapping[str, Sequence[tuple[str, str]]]) -> str:
    row = some[0].asked.row
    parts = [f"## {_heading(some[0])}\n", f"{row.set_up}\n", f"> {row.printed}\n"]
    parts += [f"{row.note}\n"] if row.note else []
    for result in some:
        if result.cases:
            parts.append(f"### {name}, preset {result.asked.preset}\n")
        parts += [_findings(result), *_cases(result)]
        parts += [f"![{words}]({link})\n" for link, words in drawn.get(_key(result), ())]
    return "\n".join(parts)


def _findings(result: Result) -> str:
    lines = ["| figure | paper | ours | verdict | one run |", "| --- | --- | --- | --- | --- |"]
    for f in result.findings:
        shown = see(result, f)
        lines.append(f"| {f.what} | {f.printed} | {f.ours} | {MARKS[f.judgement]} | {f'`{shown}`' if shown else ''} |")
    lines += ["", *(f"*{f.what}*: {f.judgement}, since {f.because}.\n" for f in result.findings if f.because)]
    lines += [f"- {case_of(one)}, seed {one.get('seed')} did not run: {one.get('error')}" for one in result.failed]
    return "\n".join(lines)


def _cases(result: Result) -> list[str]:
    """What was measured, case by case."""
    if not result.measures:
        return []
    keys = dict.fromkeys(key for one in result.measures for key in one if key not in UNMEASURED)
    cases = _kinds(result)
    lines = [
        "| case | episodes | " + " | ".join(key.replace("_", " ") for key in keys) + " |",
        "| --- | ---: |" + " ---: |" * len(keys),
    ]
    lines += [
        f"| {name} | {len(some)} | " + " | ".join(_cell(some, key) for key in keys) + " |"
        for name, some in cases
        if some
    ]
    return ["\n".join(lines) + "\n"]


def _cell(some: Sequence[Measures], key: str) -> str:
    """Shares for what is true or false, otherwise median and range."""
    values = [one.get(key) for one in some if one.get(key) is not None]
    if not values:
        return "-"
    if all(isinstance(value, bool) for value in values):
        return f"{sum(value is True for value in values)} of {len(values)}"
    if not numbers(some, key):
        return ", ".join(dict.fromkeys(map(str, values)))
    if len(dict.fromkeys(numbers(some, key))) == 1:
        return f"{numbers(some, key)[0]:g}"
    whole = all(isinstance(value, int) for value in values)
    least = max(abs(value) for value in numbers(some, key))
    return spread(some, key, "", 1.0, 0 if whole else 1 if least >= 10 else 2).split(", n =")[0] + ")"


def _write_csv(path: Path, every: Sequence[Result]) -> None:
    rows = [one for result in every for one in (*result.measures, *result.failed)]
    head = dict.fromkeys(("row", "preset", "case", "seed", "error"))
    names = [*head, *dict.fromkeys(key for one in rows for key in one if key not in UNMEASURED)]
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(names)
        table.writerows(["" if one.get(name) is None else _plain(one[name]) for name in names] for one in rows)


def _plain(value: object) -> object:
    match value:
        case bool():
            return "true" if value else "false"
        case float():
            return f"{value:.6g}"
        case _:
            return value


# --- pictures -----------------------------------------------------------------------------------------


def _draw(result: Result, folder: Path) -> Iterator[tuple[Path, str]]:
    """One run from above, and how the measures spread."""
    shown = _shown(result)
    if shown is not None:
        case, finding = shown
        assert finding.seed is not None
        path = folder / f"{_key(result)}.png"
        picture(Shown(result.asked, case), finding.seed, path)
        yield path, f"{result.asked.row.name}, {case.name}, seed {finding.seed}: one run from above"
        yield from _maps(Shown(result.asked, case), finding.seed, folder / f"{_key(result)}-maps.png")
    yield from _draw_courses(result, folder)
    plots = [plot for plot in result.asked.row.plots if numbers(result.measures, plot.key)]
    if plots:
        path = folder / f"{_key(result)}-spread.png"
        draw_plots(result, plots, path)
        yield path, f"{result.asked.row.name}: share of the episodes below each value; green: the paper's figure"


def _maps(shown: Shown, seed: int, path: Path) -> Iterator[tuple[Path, str]]:
    if shown.asked.row.maps:
        draw_maps(shown, seed, path)
        words = "; ".join(one.words for one in shown.asked.row.maps)
        yield path, f"{shown.asked.row.name}, {shown.case.name}, seed {seed}: {words}"


def _draw_courses(result: Result, folder: Path) -> Iterator[tuple[Path, str]]:
    """The runs that the row draws in its own way."""
    row = result.asked.row
    for case in result.cases:
        if row.draw is None or case.name not in row.courses:
            continue
        title = f"{row.name}, {case.name}, seed {case.seeds[0]}"
        path = folder / f"{_key(result)}-{_word(case.name)}.png"
        row.draw(seen(Shown(result.asked, case), case.seeds[0]), title, path)
        yield path, title


def _word(name: str) -> str:
    """A name as part of the name of a file."""
    return "-".join("".join(letter if letter.isalnum() else " " for letter in name.lower()).split())


def _shown(result: Result) -> tuple[Case, Finding] | None:
    """The first finding that has a run to see, of the case that the row wants to show if there is one."""
    wanted = result.asked.row.picture
    for finding in sorted(result.findings, key=lambda finding: finding.case != wanted):
        case = next((case for case in result.cases if case.name == finding.case), None)
        if case is not None and finding.seed is not None:
            return case, finding
    return None


def draw_plots(result: Result, plots: Sequence[Plot], path: Path) -> None:
    """The share of episodes below each value, a curve a case, side by side."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(4.6 * len(plots), 3.4), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    for axes, plot in zip(figure.subplots(1, len(plots), squeeze=False)[0], plots, strict=True):
        _draw_plot(axes, result, plot)
    figure.savefig(path, format="png", metadata={"Software": None})


def _draw_plot(axes: Axes, result: Result, plot: Plot) -> None:
    if plot.band is not None:
        axes.axvspan(*plot.band, color=BAND, lw=0, zorder=0)
    for k, (name, some) in enumerate(_kinds(result)):
        values = [value * plot.scale for value in numbers(some, plot.key)]
        if values:
            axes.ecdf(values, color=COLOURS[k % len(COLOURS)], lw=1.8, label=f"{name} ({len(values)})")
    axes.set(xlabel=plot.label, ylabel="share of episodes", ylim=(0, 1.02), facecolor="#f8f9fb")
    axes.grid(color="#e4e8ee", lw=0.8)
    axes.legend(fontsize=7.5, frameon=False, loc="lower right", labelcolor=INK)


def _kinds(result: Result) -> list[tuple[str, list[Measures]]]:
    """The episodes case by case; where there are many cases, those with the same words before the colon together."""
    many = len(result.cases) > MOST_CASES
    kinds = dict.fromkeys(_kind(case.name, many) for case in result.cases)
    return [(kind, [m for m in result.measures if _kind(case_of(m), many) == kind]) for kind in kinds]


def _kind(case: str, many: bool) -> str:
    return case.split(":")[0] if many else case
