"""Numbers with units (L3) and their canonical text (L21).

Takes: the text of a number. Gives: its SI value and unit, and back. Leaves alone: whether a dimension fits its place.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from decimal import Decimal, localcontext

_PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899862803482534211707")
_LENGTHS = {"m": "1", "cm": "0.01", "mm": "0.001", "km": "1000", "ft": "0.3048", "in": "0.0254"}
_TIMES = {"s": "1", "ms": "0.001", "min": "60"}
_GUARD_DIGITS = 60


@dataclass(frozen=True, slots=True)
class Unit:
    """One such unit is `times / over` of the SI unit `si`."""

    si: str
    times: Decimal = Decimal(1)
    over: Decimal = Decimal(1)


def _units() -> dict[str, Unit]:
    lengths = {name: Unit("m", Decimal(factor)) for name, factor in _LENGTHS.items()}
    times = {name: Unit("s", Decimal(factor)) for name, factor in _TIMES.items()}
    angles = {"rad": Unit("rad"), "deg": Unit("rad", _PI, Decimal(180))}
    others = {"A": Unit("A"), "%": Unit("%", Decimal(1), Decimal(100))}
    rates = {f"{name}/s": Unit(f"{unit.si}/s", unit.times, unit.over) for name, unit in (lengths | angles).items()}
    return lengths | times | angles | others | rates


UNITS: dict[str, Unit] = _units()
"""Every unit that may stand behind a number, without the bare number."""

SI_UNITS: tuple[str, ...] = ("m", "s", "rad", "A", "%", "m/s", "rad/s")

KNOWN_UNITS = "m cm mm km ft in, s ms min, rad deg, A, %, and LENGTH/s or ANGLE/s"
"""The units as a message lists them."""

_DIMENSIONS = {
    "": "bare number",
    "m": "length",
    "s": "time",
    "rad": "angle",
    "A": "current",
    "%": "fraction",
    "m/s": "speed",
    "rad/s": "turn rate",
}

_NUMBER = re.compile(r"([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,4})?)(.*)", re.DOTALL)


class BadNumberError(ValueError):
    """The text is no number; the words say why, `hint` how to mend it."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.hint = hint


def dimension(unit: str) -> str:
    """What a number of this SI unit measures, as messages say it: "m" is a "length"."""
    return _DIMENSIONS[unit]


def read_number(text: str) -> tuple[float, str]:
    """The SI value and the SI unit ("" for none) of a number token; raises BadNumberError.

    Converted in decimal and rounded once: `57cm` is the float 0.57. `50%` is 0.5 with the unit "%".
    """
    match = _NUMBER.fullmatch(text)
    if match is None:
        raise BadNumberError(f"`{text}` begins like a number and is none", "a name cannot begin with a digit")
    digits, name = match.groups()
    if name and name not in UNITS:
        raise BadNumberError(f"`{text}`: `{name}` is not a unit", f"known units: {KNOWN_UNITS}")
    unit = UNITS[name] if name else Unit("")
    with localcontext() as context:
        context.prec = len(digits) + _GUARD_DIGITS
        value = float(Decimal(digits) * unit.times / unit.over)
    if value in (float("inf"), float("-inf")):
        raise BadNumberError(f"`{text}` is too large a number")
    return value + 0.0, unit.si


def canonical_number(value: float, unit: str) -> str:
    """The shortest text that reads back as this SI value and unit, without a point where it is whole: `7.62m`, `2s`."""
    return _shortest(value) + unit if unit != "%" else _percent(value)


def _percent(value: float) -> str:
    if value - value != 0.0:
        return f"{value!r}%"
    with localcontext() as context:
        context.prec = _GUARD_DIGITS
        return f"{_plain(str((Decimal(repr(value + 0.0)) * 100).normalize()))}%"


def _shortest(value: float) -> str:
    return _plain(repr(value + 0.0))


def _plain(text: str) -> str:
    """Without `.0`, a plus or leading noughts in the exponent, and in full where that is no longer."""
    mantissa, _, exponent = text.lower().partition("e")
    mantissa = mantissa.removesuffix(".0")
    if not exponent:
        return mantissa
    power = int(exponent)
    if 0 <= power <= 15 and "." not in mantissa:
        return mantissa + "0" * power
    return f"{mantissa}e{power}"
