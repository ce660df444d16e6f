"""What a beacon sounds like: signal over noise by distance and by angle off the axis, and back.

Takes: distances, offsets, signals. Gives: expected signals, chances to be heard, a range, whether the sun is to blame.
Leaves alone: where beacons are (cores/beacon_grid.py).
Source: the reader of Bonasso, Antonisse and Slack 1992 hears 25 feet far and is deaf with the sun behind the beacon;
the inverse square law and the square of the cosine are our model of it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from behaviours.interface import Floats

NEAREST = 0.1
"""[m] from where a signal grows no more."""


@dataclass(frozen=True, slots=True)
class BeaconModel:
    """signal: signal over noise at `edge` [m] on the axis; heard: the least that the reader hears; sd: of its noise.

    half_field [rad] of the reader; sun: the sun makes the noise so many times greater.
    """

    signal: float = 3.2
    edge: float = 25 * 0.3048
    heard: float = 3.0
    sd: float = 0.2
    half_field: float = math.radians(30.0)
    sun: float = 10.0


def expected(distance: Floats, offset: Floats, model: BeaconModel) -> Floats:
    """Signal over noise of beacons so far [m] and so far off the axis [rad]; 0 out of the field."""
    there = model.signal * (model.edge / np.maximum(distance, NEAREST)) ** 2 * np.cos(offset) ** 2
    return np.where(np.abs(offset) < model.half_field, there, 0.0)


def chance_to_hear(signal: Floats, model: BeaconModel) -> Floats:
    """Chance that a fixation with this expected signal is heard; the logistic curve that is like the normal one."""
    return np.asarray(1.0 / (1.0 + np.exp(np.clip(-1.702 * (signal - model.heard) / model.sd, -50.0, 50.0))))


def range_by_strength(heard: Sequence[tuple[float, float]], model: BeaconModel) -> float:
    """Distance [m] of a beacon heard with (offset [rad], signal): the median; NaN where nothing was heard.

    Too far in sunlight, whose noise the reader takes for that of a dull day.
    """
    on_axis = [signal / math.cos(offset) ** 2 for offset, signal in heard if signal > 0.0 and math.cos(offset) > 0.0]
    return model.edge * math.sqrt(model.signal / float(np.median(on_axis))) if on_axis else math.nan


def suspects_sun(signals: Sequence[float], model: BeaconModel) -> bool:
    """Whether the signals of a sweep in which too little was heard look like a beacon before the sun.

    A beacon within the edge is then heard with a tenth of its signal: a faint swelling, far above what noise alone
    makes of the mean of neighbours, far below what is heard. A beacon twice as far as the edge looks the same.
    """
    width = 15
    if len(signals) < width:
        return False
    swelling = float(np.convolve(signals, np.full(width, 1.0 / width), "valid").max())
    return model.signal / model.sun * 0.8 < swelling < 0.7 * model.heard
