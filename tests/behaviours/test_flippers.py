"""Flippers come out while the drive motors labour, and go home when they have not for ten seconds."""

from __future__ import annotations

from pathlib import Path

import pytest

from behaviours.catalogue import LIBRARIES
from behaviours.cores.flippers import Labour, LabourSettings
from behaviours.interface import Currents, FlipperState, Odometry, Pose, Reading, Workshop
from rplan.apps.reproduce.rows import w5
from rplan.apps.reproduce.watch import watch
from rplan.apps.wiring import compile_file
from sim.scenarios.format import load

FREE, SPIKE = 1.5, 25.0
PLANS = Path(__file__).parents[2] / "plans"


def run(draws, step, until=30.0, settings=None):
    """When the flippers are wanted out, for what the motors draw, `draws(t)` -> (left, right) [A]."""
    labour, out = Labour(settings or LabourSettings()), []
    for k in range(round(until / step)):
        labour.take(k * step, *draws(k * step))
        if labour.out:
            out.append(k * step)
    return out


def spike(begin, end, left=SPIKE, right=FREE):
    return lambda t: (left, right) if begin - 1e-9 <= t < end - 1e-9 else (FREE, FREE)


def test_a_spike_of_a_second_at_two_has_them_out_from_two_to_twelve_point_eight():
    out = run(spike(2.0, 3.0), 0.2)
    assert out[0] == pytest.approx(2.0)
    assert out[-1] + 0.2 == pytest.approx(12.8)


def test_inrush_shorter_than_the_low_pass_does_not_count():
    assert run(spike(2.0, 2.1), 0.02) == []
    assert run(spike(2.0, 2.1), 0.02, settings=LabourSettings(smoothing=0.0)) != []


def test_either_motor_deploys():
    assert run(spike(2.0, 3.0), 0.1) == run(spike(2.0, 3.0, FREE, SPIKE), 0.1) != []


def test_currents_count_backwards_too():
    assert run(spike(2.0, 3.0, -SPIKE, -FREE), 0.1) == run(spike(2.0, 3.0), 0.1)


def test_both_motors_must_rest_before_they_go_home():
    tired = run(lambda t: (SPIKE, FREE) if 2 <= t < 3 else (2.5, FREE) if t < 20 else (FREE, FREE), 0.1)
    assert tired[-1] == pytest.approx(20.2, abs=0.21)


def test_labouring_again_starts_the_ten_seconds_anew():
    once = run(spike(2.0, 3.0), 0.1)[-1]
    again = run(lambda t: (SPIKE, FREE) if 2 <= t < 3 or 8 <= t < 9 else (FREE, FREE), 0.1)
    assert again[-1] == pytest.approx(once + 6.0)
    assert len(again) == len(run(spike(2.0, 3.0), 0.1)) + 60


def test_thresholds_themselves_do_not_count():
    sharp = LabourSettings(smoothing=0.0)
    assert run(lambda t: (15.0, 15.0), 0.1, settings=sharp) == []
    stay = run(lambda t: (15.1, 0.0) if t < 0.05 else (2.0, 2.0), 0.1, settings=sharp)
    assert stay[-1] == pytest.approx(29.9)
    home = run(lambda t: (15.1, 0.0) if t < 0.05 else (1.9, 1.9), 0.1, settings=sharp)
    assert home[-1] == pytest.approx(9.9)


def test_the_library_tells_what_is_wanted_and_what_is():
    workshop = Workshop()
    offer = LIBRARIES["flippers"].build({}, workshop)
    reading = Reading(
        0.0,
        0,
        Odometry(Pose(0, 0), 0.0, 0.0),
        currents=Currents(0.0, True, 20.0, 1.0),
        flippers=FlipperState(0.5, False),
    )
    for estimator in workshop.estimators:
        estimator.update(reading, {}, {})
    assert offer.percepts["the-tracks-labour"]() is True
    assert offer.percepts["the-flippers-are-out"]() is False
    for name, deployed in (("deploy-flippers", True), ("retract-flippers", False)):
        offer.competences[name].start(reading, {})
        command, _ = offer.competences[name].step(reading, {})
        assert command.flippers.deployed is deployed and command.drive is None


def test_a_robot_without_current_sensors_never_labours():
    workshop = Workshop()
    offer = LIBRARIES["flippers"].build({}, workshop)
    for estimator in workshop.estimators:
        estimator.update(Reading(0.0, 0, Odometry(Pose(0, 0), 0.0, 0.0)), {}, {})
    assert offer.percepts["the-tracks-labour"]() is False


@pytest.mark.parametrize("seed", [0, 1])
def test_a_curb_is_crossed_with_flippers_out_once_and_home_soon(seed):
    seen = watch(
        compile_file(PLANS / "perimeter" / "perimeter.rplan"), load(PLANS / "perimeter/worlds/curb.yaml"), seed
    )
    told = w5.measure(seen)
    assert told["crossed"] and told["deployed"] == 1 and told["home_in_time"]
    assert not told["stuck"]
