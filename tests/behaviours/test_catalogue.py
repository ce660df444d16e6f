"""The catalogue: what is offered is there, parameters reach what they name, and mistakes are told."""

import math
from dataclasses import is_dataclass

import pytest

from behaviours.catalogue import LIBRARIES, library
from behaviours.estimators.ir_search import IrSearch
from behaviours.interface import ACTUATORS, Workshop

NAMES = sorted(LIBRARIES)


def built(*names, **values):
    workshop = Workshop()
    return [library(n).build(values.get(n.replace("-", "_"), {}), workshop) for n in names], workshop


def test_the_libraries_are_there():
    assert NAMES == [
        "drive",
        "find-and-fetch",
        "flippers",
        "ir-search",
        "localisation",
        "mapping",
        "natigation",
        "patrol",
        "perimeter",
        "recent-path",
        "robot",
        "runaway",
        "sensors",
        "stasis",
        "stereo-search",
        "svfh",
        "wall-by-hough",
        "wall-by-ransac",
    ]
    with pytest.raises(TypeError):
        LIBRARIES["mine"] = library("robot")


@pytest.mark.parametrize("name", NAMES)
def test_every_word_is_brought_to_life_as_what_it_was_offered(name):
    (offer,), _ = built(name)
    numbers = {**offer.percepts, **offer.values}  # a percept, or what a channel of numbers is filled with
    by_type = {"command": offer.competences, "pose": offer.values, "bool": offer.percepts, "number": numbers}
    for function in library(name).functions:
        assert function.name in by_type[function.type]
    assert len(library(name).functions) == len(offer.percepts) + len(offer.values) + len(offer.competences)


@pytest.mark.parametrize("name", NAMES)
def test_percepts_have_the_type_that_they_were_offered_as_before_any_reading(name):
    (offer,), _ = built(name)
    for function in library(name).functions:
        if function.name in offer.percepts:
            value = offer.percepts[function.name]()
            assert isinstance(value, bool) if function.type == "bool" else math.isfinite(value)


@pytest.mark.parametrize("name", NAMES)
def test_words_and_parameters_are_documented_and_named_once(name):
    item = library(name)
    names = [f.name for f in item.functions] + [p.name for p in item.parameters]
    assert len(set(names)) == len(names)
    assert all(thing.doc.endswith(".") for thing in (*item.functions, *item.parameters))
    assert all(set(f.actuators) <= set(ACTUATORS) for f in item.functions)
    assert all(f.actuators for f in item.functions if f.type == "command")


@pytest.mark.parametrize("name", NAMES)
def test_the_defaults_given_outright_make_the_same_library(name):
    values = {p.name: p.default for p in library(name).parameters}
    assert settings_of(name, values) == settings_of(name, {})


def test_what_is_not_the_default_makes_another_library():
    assert settings_of("runaway", {"safety-radius": 0.4}) != settings_of("runaway", {})


def settings_of(name, values):
    """What estimators and competences of a library were set to, as text."""
    (offer,), workshop = built(name, **{name.replace("-", "_"): values})
    made = [*workshop.estimators, *offer.competences.values()]
    held = [getattr(one, field, None) for one in made for field in (*getattr(one, "__slots__", ()), *vars_of(one))]
    return [repr(one) for one in held if is_dataclass(one) and one.__dataclass_params__.frozen]


def vars_of(thing):
    return vars(thing) if hasattr(thing, "__dict__") else ()


def test_a_parameter_reaches_what_it_names(standin):
    world = standin.World(discs=[standin.Disc(0.35 + 0.3 + 0.25, 0.0, 0.25)], sonar_sd=0.0)
    careful = standin.Robot("runaway", runaway={"safety-radius": 0.4})
    bold = standin.Robot("runaway")
    reading = world.read()
    assert careful.sense(reading)["anything-is-too-close"] and not bold.sense(reading)["anything-is-too-close"]


@pytest.mark.parametrize("value", [-0.1, math.inf, math.nan])
def test_a_parameter_out_of_range_is_an_error_that_names_it(value):
    with pytest.raises(ValueError, match="safety-radius"):
        built("runaway", runaway={"safety-radius": value})


def test_a_count_must_be_whole():
    with pytest.raises(ValueError, match="obstacles must be a whole number"):
        built("natigation", natigation={"obstacles": 2.5})


def test_an_object_as_high_as_the_camera_is_an_error():
    with pytest.raises(ValueError, match="object-height"):
        built("stereo-search", stereo_search={"object-height": 1.2})


def test_libraries_share_what_they_both_need():
    _, workshop = built("ir-search", "stereo-search", "find-and-fetch", "natigation", "robot")
    assert sum(isinstance(e, IrSearch) for e in workshop.estimators) == 1


def test_parameters_that_would_come_too_late_are_an_error():
    with pytest.raises(ValueError, match="use ir-search before"):
        built("find-and-fetch", "ir-search", ir_search={"step": 0.1})


def test_estimators_are_updated_after_those_that_they_read():
    _, workshop = built("find-and-fetch")
    kinds = [type(e).__name__ for e in workshop.estimators]
    assert kinds.index("IrSearch") < kinds.index("StereoSearch") < kinds.index("DonorMemory")
