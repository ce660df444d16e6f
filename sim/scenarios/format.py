"""The file format of scenarios: from YAML to `Scenario`, and the same as JSON Schema.

Takes: YAML text. Gives: `Scenario`, or every mistake with its place. Leaves alone: what the seed decides.
The format is what `SCENARIO` at the end says; keys carry the names of the dataclasses' fields. The schema in
`scenario.schema.json` is printed from it: `python -m sim.scenarios.format`.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

import yaml

from behaviours.interface import Pose
from sim.scenarios.measures import (
    angle,
    coordinate,
    duration,
    fields_of,
    length,
    moment,
    pair,
    point,
    pose,
    positive,
    region,
    share,
    speed,
)
from sim.scenarios.robots import robot
from sim.scenarios.scenario import (
    SCATTERED,
    Change,
    DonorSpec,
    Event,
    Goal,
    Jam,
    KeepClear,
    Put,
    Round,
    Scatter,
    Scenario,
    ThingSpec,
    Vanish,
)
from sim.scenarios.schema import (
    Json,
    Key,
    Problem,
    Report,
    ScenarioError,
    Spec,
    Wrong,
    by_kind,
    choice,
    did_you_mean,
    flag,
    listed,
    quantity,
    read,
    record,
    row,
    scalar_or,
    whole,
    word,
)
from sim.scenarios.things import THINGS, trigger
from sim.sensors.build import FAULTS, Fault
from sim.sensors.faults import wrong_fault
from sim.sensors.weather import Weather
from sim.things.ground import Ground, Slope
from sim.things.thing import Shift


def load(path: Path) -> Scenario:
    """The scenario in a YAML file. Raises ScenarioError with every problem; OSError where it cannot be read."""
    try:
        text = path.read_bytes().decode("utf-8")
    except UnicodeDecodeError as fault:
        raise ScenarioError([Problem(path.name, 1, 1, "", "not a text in UTF-8")]) from fault
    return loads(text, path.name)


def loads(text: str, name: str = "scenario") -> Scenario:
    """The scenario in a YAML text; `name` stands for the file in messages. Raises ScenarioError."""
    return read(text, name, SCENARIO)


# --- the task and the rest ----------------------------------------------------------------------------

move = record(
    Shift,
    starts=Key(trigger, goes_to="start"),
    by=Key(row(pair, "a way [dx, dy]", coordinate, coordinate)),
    speed=Key(speed, 0.3),
)
donor = record(
    DonorSpec,
    at=Key(point),
    radius=Key(positive, 0.25),
    height=Key(positive, 0.9),
    reach=Key(positive, 0.92),
    hand_over=Key(moment, 15.0),
    move=Key(move, None),
    trips=Key(whole(1, 1000), 1, doc="how many objects it holds"),
    id=Key(word, "donor"),
)


def _home(unload: float) -> float:
    return unload


home = record(_home, unload=Key(duration, doc="of standing at home until an object is taken off"))
goal = record(Goal, at=Key(point), within=Key(positive, 1.0), no_contact=Key(flag, False))
around = record(
    Round, about=Key(point), turns=Key(whole(1, 1000), 1), within=Key(positive, 3.0), no_contact=Key(flag, False)
)
place = scalar_or(choice("robot", "donor"), point)
strip = record(KeepClear, **{"from": Key(place, goes_to="start")}, to=Key(place, goes_to="end"), by=Key(length))


def _ordered(least: int, most: int) -> tuple[int, int]:
    if least > most:
        raise ValueError("the first of the two numbers must not be the greater")
    return least, most


scatter = record(
    Scatter,
    kinds=Key(listed(choice(*SCATTERED), 1)),
    count=Key(row(_ordered, "how many [least, most]", whole(0, 100), whole(0, 100))),
    region=Key(region),
    min_gap=Key(length, 0.0),
    keep_clear=Key(listed(strip), ()),
)
weather = fields_of(Weather(), {"sun": angle, "jitter": angle, "gust": angle, "gusts": share})
slope = record(Slope, region=Key(region), rise=Key(quantity("angle", above=0, most=1)), uphill=Key(angle))


JAMS = ("free", "light-jam", "bad-jam", "worst-jam")


def _event(
    at: float, vanish: str | None, put: tuple[str, Pose] | None, weather: Weather | None, head: str | None
) -> Event:
    given = [what for what in (vanish, put, weather, head) if what is not None]
    if len(given) != 1:
        raise ValueError("give one of vanish, put, weather and head")
    if head is not None:
        return Event(at, Jam(JAMS.index(head)))
    if vanish is not None:
        return Event(at, Vanish(vanish))
    return Event(at, Put(*put)) if put is not None else Event(at, Change(weather or Weather()))


def _put(thing: str, at: Pose) -> tuple[str, Pose]:
    return thing, at


event = record(
    _event,
    at=Key(moment),
    vanish=Key(word, None, doc="the id of a thing"),
    put=Key(record(_put, thing=Key(word), at=Key(pose)), None),
    weather=Key(weather, None),
    head=Key(choice(*JAMS), None, doc="it gets stuck, or is freed"),
)


def _fault(sensor: str, kind: str, at: float, until: float, amount: float) -> Fault:
    if until <= at:
        raise ValueError("'until' must be later than 'at'")
    if kind == "dropout" and not 0 <= amount <= 1:
        raise ValueError("the amount of a dropout is a chance from 0 to 1")
    return Fault(sensor, kind, at, until, amount)


fault = record(
    _fault,
    sensor=Key(word, doc="its name"),
    kind=Key(choice(*FAULTS)),
    at=Key(moment, 0.0),
    until=Key(duration, math.inf),
    amount=Key(quantity("number", least=-1e6, most=1e6), 1.0),
)


def _things(report: Report, node: yaml.Node, path: str) -> tuple[ThingSpec, ...] | Wrong:
    """Things whose ids differ."""
    things = thing_list(report, node, path)
    taken = ["robot"]
    for index, thing in enumerate(() if isinstance(things, str) else things):
        if thing.id in taken:
            report.wrong(node.value[index], f"{path}[{index}].id", f"the name {thing.id!r} is taken")
        taken += [thing.id] if thing.id else []
    return things


thing_list: Spec[tuple[ThingSpec, ...]] = listed(by_kind(THINGS))


def _scenario(
    ground: tuple[Slope, ...], donor: DonorSpec | None, donors: tuple[DonorSpec, ...], home: float | None, **rest: Any
) -> Scenario:
    if donor is not None and donors:
        raise ValueError("give 'donor' or 'donors', not both")
    donors = donors if donor is None else (donor,)
    if donors and rest["goal"] is not None:
        raise ValueError("a scenario has either a donor or a goal")
    if rest["round"] is not None and (donors or rest["goal"] is not None):
        raise ValueError("a scenario with 'round' has neither a donor nor a goal")
    return Scenario(ground=Ground(ground), donors=donors, unload=home, **rest)


def _whole(report: Report, node: yaml.Node, path: str) -> Scenario | Wrong:
    """A scenario whose events and faults speak of what is there."""
    scenario = keys_of_scenario(report, node, path)
    if isinstance(scenario, str):
        return scenario
    sensors = [sensor.name for sensor in scenario.robot.sensors]
    for index, fault in enumerate(scenario.faults):
        if fault.sensor not in sensors:
            message = f"the robot has no sensor {fault.sensor!r}; {did_you_mean(fault.sensor, sensors)}"
            report.wrong(_part(node, "faults", index), f"faults[{index}].sensor", message)
        elif message := wrong_fault(fault, scenario.robot.sensors):
            report.wrong(_part(node, "faults", index), f"faults[{index}]", message)
    things = [spec.id for spec in scenario.donors]
    for index, name in enumerate(things):
        if name in ("robot", *things[:index]):
            report.wrong(node, f"donors[{index}].id", f"the name {name!r} is taken")
    for index, thing in enumerate(scenario.things):
        if thing.id in things:
            report.wrong(_part(node, "things", index), f"things[{index}].id", f"the name {thing.id!r} is taken")
    things += [thing.id for thing in scenario.things if thing.id]
    for index, event in enumerate(scenario.events):
        match event.what:
            case Vanish(thing=name) | Put(thing=name) if name not in things:
                hint = did_you_mean(name, things) if things else "none has an id"
                report.wrong(_part(node, "events", index), f"events[{index}]", f"there is no thing {name!r}; {hint}")
            case _:
                pass
    return scenario


def _part(node: yaml.Node, key: str, index: int) -> yaml.Node:
    """The item of a list under a key of a mapping; both are there."""
    part: yaml.Node = next(value for name, value in node.value if name.value == key).value[index]
    return part


keys_of_scenario: Spec[Scenario] = record(
    _scenario,
    name=Key(word),
    bounds=Key(region, doc="what is shown"),
    robot=Key(robot),
    donor=Key(donor, None, doc="the task: fetch its object"),
    donors=Key(listed(donor, 1), (), doc="several; their ids differ"),
    home=Key(home, None),
    goal=Key(goal, None, doc="the task: reach this place"),
    round=Key(around, None, doc="the task: go round this place and come back"),
    things=Key(Spec(_things, thing_list.schema), ()),
    scatter=Key(listed(scatter), ()),
    weather=Key(weather, Weather()),
    ground=Key(listed(slope), ()),
    events=Key(listed(event), ()),
    faults=Key(listed(fault), ()),
    time_limit=Key(duration, 1800.0),
    source=Key(word, ""),
    left_out=Key(listed(word), ()),
)
SCENARIO: Spec[Scenario] = Spec(_whole, keys_of_scenario.schema)


def schema() -> Json:
    """The format as JSON Schema (draft 2020-12)."""
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "rplan scenario"}
    return {**head, **SCENARIO.schema}


if __name__ == "__main__":
    sys.stdout.write(json.dumps(schema(), indent=1) + "\n")
