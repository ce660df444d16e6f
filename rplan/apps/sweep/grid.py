"""What the user asks of a sweep: seeds, and values of parameters of the plan and of its scenarios.

Takes: the texts of options, a compiled plan, scenarios. Gives: seeds and `Variant`s; `GridError` with every mistake,
before anything runs. Leaves alone: running.

`LIBRARY.PARAMETER=V,…` is checked by the plan language itself, as if it stood in the plan's `use`, and
`scenario.KEY…=V,…` by loading the scenario with the key changed.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import yaml

from rplan.apps.libraries import Catalogue
from rplan.apps.simulation import World
from rplan.apps.sweep.work import Change, Value, Variant, changed
from rplan.apps.wiring import crew, signature
from rplan.driver import Compiled, load
from rplan.goals.expand import expand
from rplan.lang.diagnostic import PlanError
from rplan.lang.source import Source
from rplan.lang.suggest import close
from sim.scenarios.format import loads
from sim.scenarios.schema import Problem, ScenarioError

MOST = 1_000_000
"""Episodes of one sweep."""
NULL, TEXT, MAPPING = (f"tag:yaml.org,2002:{name}" for name in ("null", "str", "map"))
GREATEST_SEED = 2**63 - 1
SCENARIO = "scenario."

SEEDS = re.compile(r"(\d{1,19})(?:\.\.(\d{1,19}))?")
WORD = re.compile(r'[^\s()";:?,]+')
PATH = re.compile(r"[\w-]+(?:\[\d+\])*(?:\.[\w-]+(?:\[\d+\])*)*")
STEP = re.compile(r"[\w-]+|\[\d+\]")


class GridError(Exception):
    """What is asked for cannot be run; `problems`: one line each."""

    def __init__(self, problems: Iterable[str]) -> None:
        self.problems = tuple(dict.fromkeys(problems))
        super().__init__("\n".join(self.problems))


@dataclass(frozen=True, slots=True)
class Loaded:
    """A scenario file and what is in it."""

    file: Path
    world: World


@dataclass(frozen=True, slots=True)
class Choice:
    """One value of a parameter. text: as it is written; value: as rows have it; change: of the plan, if it is one."""

    text: str
    value: Value
    change: Change | None = None


@dataclass(frozen=True, slots=True)
class Axis:
    """A parameter and its values. path: the key in the scenario, empty for a parameter of the plan."""

    name: str
    path: tuple[str | int, ...]
    choices: tuple[Choice, ...]


# --- seeds --------------------------------------------------------------------------------------------


def seeds(texts: Iterable[str]) -> tuple[int, ...]:
    """`0..9,12`: numbers and ranges with both ends, each seed once, in order. Raises GridError."""
    ranges = [_seeds(part.strip()) for text in texts for part in text.split(",")]
    if sum(map(len, ranges)) > MOST:
        raise GridError([f"--seeds: more than {MOST:,} seeds"])
    return tuple(sorted({seed for some in ranges for seed in some}))


def _seeds(text: str) -> range:
    matched = SEEDS.fullmatch(text)
    first, last = (int(matched[1]), int(matched[2] or matched[1])) if matched else (0, -1)
    if first > last or last > GREATEST_SEED:
        raise GridError([f"--seeds: expected whole numbers such as 0..99 or 3,5,10..20, got {text!r}"])
    return range(first, last + 1)


# --- parameters ---------------------------------------------------------------------------------------


def axes(texts: Sequence[str], compiled: Compiled, libraries: Catalogue) -> tuple[Axis, ...]:
    """The swept parameters, in the order in which they are given. Raises GridError."""
    found: list[Axis] = []
    problems: list[str] = []
    for text in texts:
        try:
            found.append(_axis(text, compiled, libraries))
        except GridError as error:
            problems += [f"--param {text}: {problem}" for problem in error.problems]
    names = [axis.name for axis in found]
    problems += [f"--param {name}=…: it is given twice" for name in names if names.count(name) > 1]
    if problems:
        raise GridError(problems)
    return tuple(found)


def _axis(text: str, compiled: Compiled, libraries: Catalogue) -> Axis:
    name, equals, values = text.partition("=")
    name = name.strip()
    if not equals or "." not in name:
        raise GridError(["expected LIBRARY.PARAMETER=VALUE,… or scenario.KEY=VALUE,…"])
    parts = split(values)
    if not all(parts):
        raise GridError(["a value is empty"])
    if name.startswith(SCENARIO):
        axis = Axis(name, path(name.removeprefix(SCENARIO)), _alike([_scenario_choice(part) for part in parts]))
    else:
        axis = Axis(name, (), _plan_choices(name, parts, compiled, libraries))
    seen: list[object] = []
    for choice in axis.choices:
        if choice.value in seen:
            raise GridError([f"the value {choice.text} is given twice"])
        seen.append(choice.value)
    return axis


def split(values: str) -> list[str]:
    """The parts between commas that stand in no bracket."""
    parts, depth = [""], 0
    for letter in values:
        depth += (letter in "[{") - (letter in "]}")
        if letter == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts]


def _plan_choices(name: str, parts: list[str], compiled: Compiled, libraries: Catalogue) -> tuple[Choice, ...]:
    library, _, parameter = name.partition(".")
    used = [bound.name for bound in compiled.goals.libraries]
    if library not in used:
        meant = close(library, used)
        hint = f"did you mean `{meant}`?" if meant else f"it uses: {', '.join(used) or 'none'}"
        hint += "; keys of the scenario begin with `scenario.`"
        raise GridError([f"the plan uses no library `{library}` ({hint})"])
    choices: list[Choice] = []
    problems: list[str] = []
    for part in parts:
        try:
            value = _setting(library, parameter, part, libraries)
        except GridError as error:
            problems += error.problems
            continue
        choices.append(Choice(part, value, Change(library, parameter, value)))
    if problems:
        raise GridError(problems)
    return tuple(choices)


def _setting(library: str, parameter: str, text: str, libraries: Catalogue) -> float | bool | str:
    """The value (SI) that `(use LIBRARY :PARAMETER TEXT)` gives."""
    if not WORD.fullmatch(parameter):
        raise GridError([f"`{library}.{parameter}` is no name of a parameter"])
    if not WORD.fullmatch(text):
        raise GridError([f"`{text}` is no value of a parameter"])
    source = Source("--param", f"(plan checked) (use {library} :{parameter} {text}) (goalem (do anything))")
    try:
        plan = load(source)
        if any(found.severity == "error" for found in plan.diagnostics):
            raise PlanError(plan.diagnostics)
        goals, _ = expand(plan.plan, {library: signature(libraries[library])})
    except PlanError as error:
        wrong = [found for found in error.diagnostics if found.severity == "error"]
        raise GridError(f"{w.message} ({w.hint})" if w.hint else w.message for w in wrong) from None
    return goals.libraries[0].settings[parameter]


# --- keys of scenarios --------------------------------------------------------------------------------


def path(text: str) -> tuple[str | int, ...]:
    """`things[0].mass` as the steps that lead to it. Raises GridError."""
    if not PATH.fullmatch(text):
        raise GridError(["expected a key of the scenario such as scenario.robot.max_speed or scenario.things[0].at"])
    if text == "name":
        raise GridError(["the name of a scenario is what tells its rows apart"])
    return tuple(int(step[1:-1]) if step.startswith("[") else step for step in STEP.findall(text))


def _scenario_choice(text: str) -> Choice:
    try:
        value = yaml.safe_load(text)
    except (yaml.YAMLError, ValueError, RecursionError):
        raise GridError([f"`{text}` is not YAML"]) from None
    return Choice(text, value if isinstance(value, bool | int | float) else text)


def _alike(choices: list[Choice]) -> tuple[Choice, ...]:
    """Values of one type, for a column: where they are not all numbers or all truths, texts."""
    kinds = {bool if isinstance(one.value, bool) else str if isinstance(one.value, str) else float for one in choices}
    return tuple(choices if len(kinds) == 1 else [Choice(one.text, one.text) for one in choices])


def with_value(text: str, steps: Sequence[str | int], value: str) -> str:
    """The YAML text with another value at a key, which need not be there yet. Raises GridError."""
    root = yaml.compose(text, Loader=yaml.SafeLoader)
    new = yaml.compose(value, Loader=yaml.SafeLoader) or yaml.ScalarNode(NULL, "")
    return yaml.serialize(_put(root, steps, new), Dumper=yaml.SafeDumper, allow_unicode=True)


def _put(node: yaml.Node | None, steps: Sequence[str | int], value: yaml.Node) -> yaml.Node:
    if not steps:
        return value
    step, rest = steps[0], steps[1:]
    match node, step:
        case yaml.SequenceNode(), int():
            if step >= len(node.value):
                raise GridError([f"there is no [{step}]: the list has {len(node.value)}"])
            items = [_put(item, rest, value) if i == step else item for i, item in enumerate(node.value)]
            return yaml.SequenceNode(node.tag, items, flow_style=node.flow_style)
        case (yaml.MappingNode(value=pairs), str()):
            return _mapping(pairs, step, rest, value)
        case None, str():
            return _mapping([], step, rest, value)
        case _:
            where = f"[{step}] in what is no list" if isinstance(step, int) else f"{step} in what is no mapping"
            raise GridError([f"there is no {where}"])


def _mapping(
    pairs: list[tuple[yaml.Node, yaml.Node]], key: str, rest: Sequence[str | int], value: yaml.Node
) -> yaml.Node:
    new = [(name, _put(old, rest, value) if name.value == key else old) for name, old in pairs]
    if all(name.value != key for name, _ in pairs):
        new.append((yaml.ScalarNode(TEXT, key), _put(None, rest, value)))
    return yaml.MappingNode(MAPPING, new, flow_style=False)


# --- variants -----------------------------------------------------------------------------------------


def variants(
    scenarios: Sequence[Loaded], axes: Sequence[Axis], compiled: Compiled, libraries: Catalogue
) -> tuple[Variant, ...]:
    """Every scenario with every combination of values. Raises GridError, also where a library refuses a combination."""
    names = [one.world.scenario.name for one in scenarios]
    problems = [f"two scenarios are called {name!r}: no row would say which" for name in names if names.count(name) > 1]
    combinations = list(product(*([(axis, choice) for choice in axis.choices] for axis in axes)))
    singles = [((axis, choice),) for axis in axes if axis.path for choice in axis.choices]
    problems += [problem for chosen in combinations for problem in _refused(chosen, compiled, libraries)]
    problems += [problem for scenario in scenarios for chosen in singles for problem in _mistakes(scenario, chosen)]
    _refuse(problems)
    problems += [
        problem for scenario in scenarios for chosen in combinations for problem in _mistakes(scenario, chosen)
    ]
    _refuse(problems)
    return tuple(_variant(scenario, chosen) for scenario in scenarios for chosen in combinations)


def _refuse(problems: list[str]) -> None:
    if problems:
        raise GridError(problems)


Chosen = tuple[tuple[Axis, Choice], ...]


def _refused(chosen: Chosen, compiled: Compiled, libraries: Catalogue) -> Iterator[str]:
    of_plan = [pair for pair in chosen if pair[1].change is not None]
    if not of_plan:
        return
    try:
        crew(changed(compiled, [choice.change for _, choice in of_plan if choice.change is not None]), libraries)
    except PlanError as error:
        yield from (f"{_said(of_plan)}: {found.message}" for found in error.diagnostics)


def _variant(scenario: Loaded, chosen: Chosen) -> Variant:
    return Variant(
        scenario.world.scenario.name,
        scenario.file.name,
        _text(scenario, chosen),
        tuple(choice.change for _, choice in chosen if choice.change is not None),
        tuple((axis.name, choice.value) for axis, choice in chosen),
    )


def _text(scenario: Loaded, chosen: Chosen) -> str:
    """The scenario with every chosen value in it."""
    text = scenario.world.text
    for axis, choice in chosen:
        if axis.path:
            text = with_value(text, axis.path, choice.text)
    return text


def _mistakes(scenario: Loaded, chosen: Chosen) -> list[str]:
    """What is wrong with the changed scenario, told with the parameter that it lies under, if it lies under one."""
    file = scenario.file.name
    of_scenario = tuple(pair for pair in chosen if pair[0].path)
    if not of_scenario:
        return []
    try:
        loads(_text(scenario, of_scenario), file)
    except ScenarioError as error:
        return [
            f"{_blamed(problem, of_scenario)}: {file}: {problem.path}: {problem.message}" for problem in error.problems
        ]
    except GridError as error:
        return [f"{_said(of_scenario)}: {file}: {problem}" for problem in error.problems]
    return []


def _blamed(problem: Problem, chosen: Chosen) -> str:
    return _said([pair for pair in chosen if problem.path.startswith(_path_text(pair[0].path))] or chosen)


def _said(chosen: Iterable[tuple[Axis, Choice]]) -> str:
    return " ".join(f"--param {axis.name}={choice.text}" for axis, choice in chosen)


def _path_text(steps: Sequence[str | int]) -> str:
    return "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in steps).removeprefix(".")
