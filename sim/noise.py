"""Chance: every source of it has its own generator, so that none disturbs another.

Takes: the seed of an episode. Gives: one `numpy.random.Generator` per source, by name.
Leaves alone: what is drawn from them. `SOURCES` are numbered in their order; every other source is told apart by its
name alone, so that a new one changes the numbers of none that stands.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

NAMED = 256  # opens each word of a name in a key: greater than any byte, so that no two keys are alike


@dataclass(frozen=True, slots=True)
class Chance:
    """The generators of one episode; layout is what the scenario leaves to the seed."""

    layout: Generator
    sonar: Generator
    infrared: Generator
    stereo: Generator
    odometry: Generator


SOURCES = tuple(Chance.__dataclass_fields__)
NUMBERED = SOURCES[1:]  # sensors of these names draw from the generators above


def chance(seed: int) -> Chance:
    """The generators of the episode with this seed >= 0."""
    return Chance(*(np.random.default_rng(child) for child in np.random.SeedSequence(seed).spawn(len(SOURCES))))


def sensor_chance(seed: int, name: str) -> Generator:
    """The generator of the sensor with this name."""
    return _keyed(seed, (SOURCES.index(name),)) if name in NUMBERED else named_chance(seed, name)


def named_chance(seed: int, *words: str) -> Generator:
    """The generator of whatever these words name, such as ("fault", "lidar")."""
    return _keyed(seed, tuple(number for word in words for number in (NAMED, *word.encode())))


def _keyed(seed: int, key: tuple[int, ...]) -> Generator:
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))
