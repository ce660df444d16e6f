"""A small declarative checker of YAML: what is expected where, and every mistake with its place.

Takes: YAML nodes (they know their lines) and specs, which go from a node to a value. Gives: the value, or
`WRONG` after noting each `Problem` in the `Report`; a mistake in one place does not hide those in others. Each spec
also carries the same expectation as a JSON Schema, for editors.
Leaves alone: what the values mean; keys and ranges are named by whoever writes the spec.

Quantities are plain numbers in SI units, or texts with a unit: 7.62, "25 ft", "60 deg".
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final, Generic, Literal, TypeVar

import yaml

T = TypeVar("T")
V = TypeVar("V", covariant=True)
Wrong = Literal["wrong"]
WRONG: Final = "wrong"  # specs never give a text of their own that is spelt so: `choice` and `word` keep it out


@dataclass(frozen=True, slots=True)
class Problem:
    """One mistake: where (line and column from 1), under which key, and what is wrong."""

    file: str
    line: int
    column: int
    path: str
    message: str

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}:{self.column}: "
        return place + (f"{self.path}: {self.message}" if self.path else self.message)


class ScenarioError(Exception):
    """The scenario is wrong; carries every problem in the order of the file."""

    def __init__(self, problems: list[Problem]) -> None:
        self.problems = tuple(sorted(problems, key=lambda problem: (problem.line, problem.column)))
        super().__init__("\n".join(map(str, self.problems)))


@dataclass(slots=True)
class Report:
    """Where the mistakes of one file are gathered."""

    file: str
    problems: list[Problem] = field(default_factory=list)

    def wrong(self, node: yaml.Node, path: str, message: str) -> Wrong:
        """Note a mistake at the node."""
        mark = node.start_mark
        self.problems.append(Problem(self.file, mark.line + 1, mark.column + 1, path, message))
        return WRONG

    def unexpected(self, node: yaml.Node, path: str, expected: str) -> Wrong:
        """Note that something else was expected at the node."""
        return self.wrong(node, path, f"expected {expected}, got {shown(node)}")


Json = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Spec(Generic[V]):
    """check: from a node under a key path to its value, or `WRONG`. schema: the same as JSON Schema."""

    check: Callable[[Report, yaml.Node, str], V | Wrong]
    schema: Json

    def __call__(self, report: Report, node: yaml.Node, path: str) -> V | Wrong:
        """The value of the node."""
        return self.check(report, node, path)


@dataclass(frozen=True, slots=True)
class Key:
    """A key of a mapping: what it holds, its default, the field it goes to (if not of the same name), what it means.

    Without a default it must be there.
    """

    spec: Spec[Any]
    default: object = WRONG
    goes_to: str = ""
    doc: str = ""


def shown(node: yaml.Node) -> str:
    """The node as a message quotes it."""
    match node:
        case yaml.MappingNode():
            return "a mapping"
        case yaml.SequenceNode():
            return f"a list of {len(node.value)}"
        case _:
            text = str(node.value)
            return repr(text if len(text) <= 40 else text[:40] + "…") if text else "nothing"


def did_you_mean(word: str, known: list[str]) -> str:
    """A hint, or the list of what is known."""
    near = difflib.get_close_matches(word, known, n=1)
    return f"did you mean {near[0]!r}?" if near else "known: " + ", ".join(known)


# --- scalars --------------------------------------------------------------------------------------

UNITS: Mapping[str, Mapping[str, float]] = {
    "length": {"m": 1.0, "cm": 0.01, "ft": 0.3048},
    "time": {"s": 1.0, "min": 60.0},
    "angle": {"rad": 1.0, "deg": math.pi / 180},
    "speed": {"m/s": 1.0, "ft/s": 0.3048},
    "number": {},
}
NAMES = {
    "length": "a length in metres",
    "time": "a time in seconds",
    "angle": "an angle in radians, or in degrees as '30 deg',",
    "speed": "a speed in metres per second",
    "number": "a number",
}
FAR_BOUND = 1e4  # bounds beyond are told only to those who pass them
QUANTITY = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)(?:\s*([a-z/]+))?")


def quantity(kind: str, above: float = -math.inf, least: float = -math.inf, most: float = math.inf) -> Spec[float]:
    """A finite number of this kind (a key of `UNITS`) within the bounds."""
    limits = [(sign, bound) for sign, bound in ((">", above), (">=", least), ("<=", most)) if math.isfinite(bound)]
    told = _expected(kind, [(sign, bound) for sign, bound in limits if abs(bound) < FAR_BOUND])

    def check(report: Report, node: yaml.Node, path: str) -> float | Wrong:
        value = _in_si(node, UNITS[kind])
        if value is None or not (above < value < math.inf and least <= value <= most):
            finite = value is not None and math.isfinite(value)
            return report.unexpected(node, path, _expected(kind, limits) if finite else told)
        return value

    return Spec(check, _number_schema(UNITS[kind], told, above, least, most))


def _expected(kind: str, limits: list[tuple[str, float]]) -> str:
    bounds = [f"{sign} {bound:g}" for sign, bound in limits]
    return " ".join([NAMES[kind].rstrip(","), " and ".join(bounds)]).strip()


def _number_schema(units: Mapping[str, float], expected: str, above: float, least: float, most: float) -> Json:
    bounds = {"exclusiveMinimum": above, "minimum": least, "maximum": most}
    number = {"type": "number"} | {name: bound for name, bound in bounds.items() if math.isfinite(bound)}
    if not units:
        return number | {"description": expected}
    pattern = r"^[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*(" + "|".join(units) + ")?$"
    return {"anyOf": [number, {"type": "string", "pattern": pattern}], "description": expected}


def _in_si(node: yaml.Node, units: Mapping[str, float]) -> float | None:
    matched = QUANTITY.fullmatch(node.value.strip()) if isinstance(node, yaml.ScalarNode) else None
    if matched is None or (matched[2] is not None and matched[2] not in units):
        return None
    return float(matched[1]) * (units[matched[2]] if matched[2] else 1.0)


def whole(least: int, most: int) -> Spec[int]:
    """A whole number within the bounds."""

    def check(report: Report, node: yaml.Node, path: str) -> int | Wrong:
        text = node.value if isinstance(node, yaml.ScalarNode) else ""
        if not re.fullmatch(r"[-+]?\d{1,9}", text) or not least <= int(text) <= most:
            return report.unexpected(node, path, f"a whole number from {least} to {most}")
        return int(text)

    return Spec(check, {"type": "integer", "minimum": least, "maximum": most})


def _word(report: Report, node: yaml.Node, path: str) -> str:
    if not isinstance(node, yaml.ScalarNode) or node.value in ("", WRONG):
        return report.unexpected(node, path, "a name")
    return str(node.value)


word: Spec[str] = Spec(_word, {"type": ["string", "number"], "minLength": 1})
"""Any text that is not empty."""


def _flag(report: Report, node: yaml.Node, path: str) -> bool | Wrong:
    text = node.value if isinstance(node, yaml.ScalarNode) else ""
    return text == "true" if text in ("true", "false") else report.unexpected(node, path, "true or false")


flag: Spec[bool] = Spec(_flag, {"type": "boolean"})


def choice(*words: str) -> Spec[str]:
    """One of these words."""

    def check(report: Report, node: yaml.Node, path: str) -> str:
        if not isinstance(node, yaml.ScalarNode) or node.value not in words:
            return report.unexpected(node, path, "one of " + ", ".join(words))
        return str(node.value)

    return Spec(check, {"enum": list(words)})


# --- what holds others ----------------------------------------------------------------------------


def listed(item: Spec[T], least: int = 0, expected: str = "a list") -> Spec[tuple[T, ...]]:
    """A tuple of items, at least so many."""

    def check(report: Report, node: yaml.Node, path: str) -> Any:
        if not isinstance(node, yaml.SequenceNode) or len(node.value) < least:
            return report.unexpected(node, path, expected + (f" of at least {least}" if least else ""))
        values = [item(report, part, f"{path}[{index}]") for index, part in enumerate(node.value)]
        return WRONG if WRONG in [value for value in values if isinstance(value, str)] else tuple(values)

    return Spec(check, {"type": "array", "items": item.schema} | ({"minItems": least} if least else {}))


def row(make: Callable[..., T], expected: str, *items: Spec[Any], optional: int = 0) -> Spec[T]:
    """A list with one item for each place, the last `optional` of which may be missing, given to `make`."""

    def check(report: Report, node: yaml.Node, path: str) -> T | Wrong:
        parts = node.value if isinstance(node, yaml.SequenceNode) else []
        if not len(items) - optional <= len(parts) <= len(items) or not parts:
            return report.unexpected(node, path, expected)
        values = [
            item(report, part, f"{path}[{index}]") for index, (item, part) in enumerate(zip(items, parts, strict=False))
        ]
        return (
            WRONG
            if WRONG in [value for value in values if isinstance(value, str)]
            else _make(report, node, path, make, values, {})
        )

    places = {"prefixItems": [item.schema for item in items], "minItems": len(items) - optional, "maxItems": len(items)}
    return Spec(check, {"type": "array", "description": expected} | places)


def record(make: Callable[..., T], **keys: Key) -> Spec[T]:
    """A mapping with these keys, given to `make` by name. `make` may raise ValueError for what does not go together."""

    def check(report: Report, node: yaml.Node, path: str) -> T | Wrong:
        if not isinstance(node, yaml.MappingNode):
            return report.unexpected(node, path, "a mapping with " + ", ".join(keys))
        nodes, sound = _entries(report, node, path, list(keys))
        values: dict[str, Any] = {}
        for name, key in keys.items():
            values[key.goes_to or name] = _value(report, node, nodes.get(name), _under(path, name), key)
        if not sound or WRONG in [value for value in values.values() if isinstance(value, str)]:
            return WRONG
        return _make(report, node, path, make, [], values)

    return Spec(check, _mapping_schema(keys))


def _mapping_schema(keys: Mapping[str, Key]) -> Json:
    properties = {
        name: {**key.spec.schema} | ({"description": key.doc} if key.doc else {}) for name, key in keys.items()
    }
    required = [name for name, key in keys.items() if isinstance(key.default, str) and key.default == WRONG]
    return {"type": "object", "properties": properties, "required": required, "additionalProperties": False}


def _make(
    report: Report, node: yaml.Node, path: str, make: Callable[..., T], parts: list[Any], named: dict[str, Any]
) -> T | Wrong:
    try:
        return make(*parts, **named)
    except ValueError as fault:
        return report.wrong(node, path, str(fault))


def _value(report: Report, whole_node: yaml.Node, node: yaml.Node | None, path: str, key: Key) -> Any:
    if node is not None:
        return key.spec(report, node, path)
    if isinstance(key.default, str) and key.default == WRONG:
        report.wrong(whole_node, path, "this key is missing")
    return key.default


def _entries(report: Report, node: yaml.MappingNode, path: str, known: list[str]) -> tuple[dict[str, yaml.Node], bool]:
    """The nodes by key, and whether every key is known and there once."""
    entries: dict[str, yaml.Node] = {}
    sound = True
    for key, value in node.value:
        name = str(key.value) if isinstance(key, yaml.ScalarNode) else shown(key)
        if name not in known:
            report.wrong(key, _under(path, name), f"unknown key; {did_you_mean(name, known)}")
        elif name in entries:
            report.wrong(key, _under(path, name), "this key is here a second time")
        sound = sound and name in known and name not in entries
        entries[name] = value
    return entries, sound


def by_kind(kinds: Mapping[str, Spec[T]]) -> Spec[T]:
    """A mapping whose key `kind` says which spec the other keys follow; its value is checked without that key."""

    def check(report: Report, node: yaml.Node, path: str) -> T | Wrong:
        pairs = node.value if isinstance(node, yaml.MappingNode) else []
        named = [value for key, value in pairs if key.value == "kind"]
        expected = "one of " + ", ".join(kinds)
        if not named:
            return report.wrong(node, path, f"expected a mapping with a key 'kind', {expected}")
        kind = str(named[0].value)
        if kind not in kinds or not isinstance(named[0], yaml.ScalarNode):
            hint = did_you_mean(kind, list(kinds)) if isinstance(named[0], yaml.ScalarNode) else expected
            return report.wrong(named[0], _under(path, "kind"), f"no such kind as {shown(named[0])}; {hint}")
        rest = [(key, value) for key, value in pairs if key.value != "kind"]
        return kinds[kind](report, yaml.MappingNode(node.tag, rest, node.start_mark, node.end_mark), path)

    return Spec(check, {"anyOf": [_kind_schema(kind, spec.schema) for kind, spec in kinds.items()]})


def _kind_schema(kind: str, schema: Json) -> Json:
    properties = {"kind": {"const": kind}, **schema["properties"]}
    return {**schema, "properties": properties, "required": ["kind", *schema["required"]]}


def scalar_or(scalar: Spec[T], other: Spec[V]) -> Spec[T | V]:
    """One spec for a scalar, another one for everything else."""
    return Spec(
        lambda report, node, path: (scalar if isinstance(node, yaml.ScalarNode) else other)(report, node, path),
        {"anyOf": [scalar.schema, other.schema]},
    )


def mapping_or(mapping: Spec[T], other: Spec[V]) -> Spec[T | V]:
    """One spec for a mapping, another one for everything else."""
    return Spec(
        lambda report, node, path: (mapping if isinstance(node, yaml.MappingNode) else other)(report, node, path),
        {"anyOf": [mapping.schema, other.schema]},
    )


def _under(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name


# --- whole files ----------------------------------------------------------------------------------


LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # libyaml where it was built in; the same nodes and places
DEEPEST = 30
"""Lists and mappings within one another; libyaml would overflow the stack, and no scenario needs half of it."""
LARGEST = 5_000_000
"""Nodes of a file, those that aliases repeat counted each time."""
OPENING = (yaml.SequenceStartEvent, yaml.MappingStartEvent)
CLOSING = (yaml.SequenceEndEvent, yaml.MappingEndEvent)


def read(text: str, file: str, spec: Spec[T]) -> T:
    """The value of a YAML text. Raises ScenarioError with every problem."""
    report = Report(file)
    node = _composed(text, file)
    value = spec(report, node, "")
    if report.problems or isinstance(value, str):
        raise ScenarioError(report.problems)
    return value


def _composed(text: str, file: str) -> yaml.Node:
    try:
        _check_depth(text, file)
        node = yaml.compose(text, Loader=LOADER)
    except yaml.MarkedYAMLError as fault:
        mark = fault.problem_mark or fault.context_mark
        line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
        raise ScenarioError([Problem(file, line, column, "", f"not YAML: {fault.problem}")]) from fault
    except (yaml.YAMLError, RecursionError, UnicodeEncodeError) as fault:
        raise ScenarioError([Problem(file, 1, 1, "", "not a YAML text")]) from fault
    if node is None:
        raise ScenarioError([Problem(file, 1, 1, "", "the file is empty; expected a scenario")])
    if _size(node, {}) > LARGEST:
        raise ScenarioError([Problem(file, 1, 1, "", f"aliases make more than {LARGEST:,} parts of it")])
    return node


def _check_depth(text: str, file: str) -> None:
    depth = 0
    for event in yaml.parse(text, Loader=LOADER):
        depth += isinstance(event, OPENING) - isinstance(event, CLOSING)
        if depth > DEEPEST:
            line, column = (event.start_mark.line, event.start_mark.column) if event.start_mark else (0, 0)
            message = f"lists and mappings lie more than {DEEPEST} deep in one another"
            raise ScenarioError([Problem(file, line + 1, column + 1, "", message)])


def _size(node: yaml.Node, sizes: dict[int, int]) -> int:
    """How many nodes it has when every alias is written out; one that holds itself counts as endless."""
    if isinstance(node, yaml.ScalarNode):
        return 1
    if id(node) not in sizes:
        sizes[id(node)] = LARGEST + 1
        parts = node.value if isinstance(node, yaml.SequenceNode) else [part for pair in node.value for part in pair]
        sizes[id(node)] = 1 + sum(_size(part, sizes) for part in parts)
    return sizes[id(node)]
