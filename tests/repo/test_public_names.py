"""What `import rplan` offers."""

from __future__ import annotations

import doctest
import subprocess
import sys

import pytest

import rplan


def test_every_public_name_is_there() -> None:
    assert all(getattr(rplan, name) for name in rplan.__all__)


def test_the_example_of_the_package_is_right() -> None:
    assert doctest.testmod(rplan).failed == 0


def test_a_name_that_is_not_there_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        _ = rplan.nothing


def test_importing_rplan_imports_no_solver() -> None:
    seen = "import rplan, sys; print([m for m in ('z3', 'lark', 'numpy', 'pymunk') if m in sys.modules])"
    said = subprocess.run([sys.executable, "-c", seen], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "[]"
