"""The caster's distances are right: a caster in extended precision, which tries every ray on every shape, agrees.

The same with 10,000 poses: `python tests/experiments/rays_exact.py --poses 10000`.
"""

from __future__ import annotations

import pytest
from experiments.rays_exact import TOLERANCE, differences

from sim.raycast_c import loops


@pytest.mark.parametrize("given", [loops, lambda: None], ids=["compiled where it can be", "arrays"])
def test_every_ray_of_two_hundred_poses_is_as_long_as_it_should_be(given):
    found = list(differences(200, 7, given))
    assert len(found) == 200
    assert max(found) < TOLERANCE
