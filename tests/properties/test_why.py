"""Explanations of random ticks are as trying every combination of percepts says."""

from __future__ import annotations

import numpy as np
import pytest
from properties.explanations import Asker, Trial, differs, usable


@pytest.mark.parametrize("seed", range(4))
def test_explanations_of_random_ticks_are_as_the_reference_says(seed: int) -> None:
    chance = np.random.default_rng(seed)
    asker = Asker(chance)
    trials = [trial for trial in (Trial(asker.plan()) for _ in range(12)) if usable(trial)]
    assert len(trials) >= 3
    for trial in trials:
        *_, tick = trial.random(chance, 3)
        assert differs(trial, tick) == ""
