"""The part of a recorded tick that has its outputs is found without decoding it, or it is said not to be there."""

from __future__ import annotations

import json

import pytest

from rplan.runtime.trace import outputs_and_sent


def line(outputs: object, sent: object, **more: object) -> str:
    """A recorded tick as a recorder writes it."""
    plan = {"inputs": "01", "registers": "", "hole": False, "outputs": outputs, "sent": sent} | more
    return json.dumps({"tick": 1, "t": 0.1, "world": {"t": 0.1}, "plan": plan}, separators=(",", ":"))


@pytest.mark.parametrize("more", [{"percepts": {"(d)": 2.0}, "started": []}, {"started": ["outputs"], "faults": []}])
@pytest.mark.parametrize(
    ("outputs", "sent"),
    [
        ({}, {}),
        ({"a": None}, {"a": [1.0, 2.0]}),
        ({"sent": "(on)", "outputs": None}, {"sent": "(on)", "outputs": '{"sent":{'}),
        ({"a": '"},"'}, {"a": 'x},"sent":{'}),
    ],
)
def test_outputs_and_what_was_sent_are_found(outputs: object, sent: object, more: dict[str, object]) -> None:
    assert json.loads(outputs_and_sent(line(outputs, sent, **more))) == {"outputs": outputs, "sent": sent}


def test_a_text_that_is_cut_within_a_value_is_not_taken_for_whole() -> None:
    found = outputs_and_sent(line({"a": None}, {"a": "x},", "b": 1}, started=[]))
    with pytest.raises(ValueError, match="Unterminated"):
        json.loads(found)


@pytest.mark.parametrize(
    "text",
    [
        "",
        '{"tick":1,"plan":null}',
        json.dumps({"plan": {"inputs": "0", "outputs": {}, "sent": {}}}),
        line({}, {}, reports={"plan": 1}).replace('"outputs"', '"out"'),
        line({}, {}, reports={"x": 1, "plan": {"inputs": "1"}}),
        line({}, {}),
    ],
)
def test_what_is_written_otherwise_is_not_guessed(text: str) -> None:
    assert outputs_and_sent(text) == ""
