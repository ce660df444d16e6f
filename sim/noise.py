"""Chance: every source of it has its own generator, so that none disturbs another.

Takes: the seed of an episode. Gives: one `numpy.random.Generator` per source, by name.
Leaves alone: what is drawn from them. A new source goes to the end of `SOURCES`, so that the others keep their numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator


@dataclass(frozen=True, slots=True)
class Chance:
    """The generators of one episode; layout is what the scenario leaves to the seed."""

    layout: Generator
    sonar: Generator
    infrared: Generator
    stereo: Generator
    odometry: Generator


SOURCES = tuple(Chance.__dataclass_fields__)


def chance(seed: int) -> Chance:
    """The generators of the episode with this seed >= 0."""
    return Chance(*(np.random.default_rng(child) for child in np.random.SeedSequence(seed).spawn(len(SOURCES))))
