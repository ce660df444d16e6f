"""Numbers and their units (L3, L21)."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rplan.lang.units import SI_UNITS, UNITS, BadNumberError, canonical_number, dimension, read_number


@pytest.mark.rule("L3")
@pytest.mark.parametrize(
    ("text", "value", "unit"),
    [
        ("57cm", 0.57, "m"),
        ("25ft", 7.62, "m"),
        ("1in", 0.0254, "m"),
        ("3km", 3000.0, "m"),
        ("1.5mm", 0.0015, "m"),
        ("70ms", 0.07, "s"),
        ("1.5min", 90.0, "s"),
        ("90deg", math.pi / 2, "rad"),
        ("180deg", math.pi, "rad"),
        ("-1deg", -math.pi / 180, "rad"),
        ("2rad", 2.0, "rad"),
        ("50%", 0.5, "%"),
        ("2A", 2.0, "A"),
        ("20cm/s", 0.2, "m/s"),
        ("180deg/s", math.pi, "rad/s"),
        (".5m", 0.5, "m"),
        ("+5.s", 5.0, "s"),
        ("1e-3m", 0.001, "m"),
        ("7", 7.0, ""),
        ("-0m", 0.0, "m"),
    ],
)
def test_a_number_is_kept_in_si(text: str, value: float, unit: str) -> None:
    assert read_number(text) == (value, unit)


@pytest.mark.rule("L3")
@given(st.integers(0, 10**20), st.integers(0, 15), st.sampled_from(["cm", "mm", "km", "ft", "in", "ms", "min"]))
def test_conversion_rounds_once(digits: int, places: int, name: str) -> None:
    text = f"{digits}e-{places}"
    factor = Fraction(UNITS[name].times)
    assert read_number(text + name)[0] == float(Fraction(digits, 10**places) * factor)


@pytest.mark.rule("L2")
@pytest.mark.parametrize(
    "text", ["0.2meters", "3d-map", "1..2", "5M", "1/2", "2 m", "1e", "m", "", "5m/min", "5s/s", "1e999m", "1e99999"]
)
def test_what_begins_like_a_number_and_is_none_is_refused(text: str) -> None:
    with pytest.raises(BadNumberError):
        read_number(text)


def test_an_unknown_unit_brings_the_known_ones() -> None:
    with pytest.raises(BadNumberError, match="`meters` is not a unit") as caught:
        read_number("0.2meters")
    assert "cm mm km" in caught.value.hint


@pytest.mark.rule("L21")
@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (7.62, "m", "7.62m"),
        (2.0, "s", "2s"),
        (0.1, "m/s", "0.1m/s"),
        (0.5, "%", "50%"),
        (0.07, "%", "7%"),
        (-3.0, "", "-3"),
        (-0.0, "m", "0m"),
        (1e22, "", "1e22"),
        (1e15, "", "1000000000000000"),
        (1.5e300, "m", "1.5e300m"),
        (1e-7, "rad", "1e-7rad"),
        (10.0, "%", "1000%"),
    ],
)
def test_canonical_text_is_the_shortest_that_reads_back(value: float, unit: str, text: str) -> None:
    assert canonical_number(value, unit) == text


@pytest.mark.rule("L21")
@given(st.floats(allow_nan=False, allow_infinity=False), st.sampled_from(["", *SI_UNITS]))
def test_canonical_text_reads_back(value: float, unit: str) -> None:
    text = canonical_number(value, unit)
    assert read_number(text) == (value, unit)
    assert not text.removesuffix(unit).endswith(".0")


@pytest.mark.parametrize("unit", ["", "%"])
def test_what_is_not_finite_still_has_a_text(unit: str) -> None:
    assert canonical_number(math.nan, unit) == f"nan{unit}"
    assert canonical_number(-math.inf, unit) == f"-inf{unit}"


def test_every_unit_has_a_dimension() -> None:
    assert dimension("m") == "length"
    assert all(dimension(unit.si) for unit in UNITS.values())
    assert [unit for unit in SI_UNITS if unit not in UNITS] == []
