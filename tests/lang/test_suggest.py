"""Which names are close (L6)."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rplan.lang.suggest import Names, close


@pytest.mark.rule("L6")
@pytest.mark.parametrize("slip", ["runawayx", "runway", "runaqay", "runaawy", "unaway", "runawa", "urnaway"])
def test_one_slip_is_close(slip: str) -> None:
    assert close(slip, ["retrieve", "runaway"]) == "runaway"


@pytest.mark.rule("L6")
@pytest.mark.parametrize("other", ["runaway", "run-awa", "runawyax", "yawanur", "rnuwaay", "r", ""])
def test_the_same_name_or_two_slips_are_not_close(other: str) -> None:
    assert close(other, ["runaway"]) is None


@pytest.mark.rule("L6")
@pytest.mark.parametrize(
    ("name", "other"), [("pose1", "pose2"), ("pose12", "pose1"), ("goals", "goals2"), ("a12bc", "a21bc")]
)
def test_digits_are_meant(name: str, other: str) -> None:
    assert close(name, [other]) is None
    assert close(other, [name]) is None


@pytest.mark.rule("L6")
def test_short_names_are_never_close() -> None:
    assert close("goat", ["goal"]) is None
    assert close("goals", ["goal"]) is None
    assert close("goals", ["goats"]) == "goats"


def test_a_caller_may_ask_for_shorter_names() -> None:
    assert close("iff", ["do", "if"], shortest=2) == "if"


def test_a_name_that_exists_is_not_close_to_another() -> None:
    assert close("search", ["search2", "searchx", "search"]) is None


def test_the_first_of_several_is_given() -> None:
    assert close("boxes", ["boxed", "foxes"]) == "boxed"
    assert close("boxes", ["foxes", "boxed"]) == "foxes"


@pytest.mark.rule("L6")
@given(st.lists(st.text("abc12-", max_size=8), max_size=8), st.text("abc12-", max_size=8))
def test_names_asked_for_many_times_are_close_as_names_asked_for_once(names: list[str], name: str) -> None:
    assert Names(names).close(name) == close(name, names)
