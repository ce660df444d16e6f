"""What holds for all tests: Hypothesis draws the same examples in every run and measures no time, and programs print as
to a plain terminal, wherever the tests run.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from hypothesis import HealthCheck, settings

settings.register_profile("steady", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("steady")

SURROUNDINGS = (
    "BUILD_NUMBER",
    "CI",
    "CLICOLOR_FORCE",
    "FORCE_COLOR",
    "LINES",
    "NO_COLOR",
    "PYTEST_ADDOPTS",
    "PYTHONIOENCODING",
    "PY_COLORS",
    "TTY_COMPATIBLE",
    "TTY_INTERACTIVE",
)
"""What changes how pytest, click and rich print: a test that is about one of them sets it."""


@pytest.fixture(scope="session", autouse=True)
def plain_terminal() -> Iterator[None]:
    """No colours, 80 columns, and a cursor that can be moved."""
    with pytest.MonkeyPatch.context() as environment:
        for name in SURROUNDINGS:
            environment.delenv(name, raising=False)
        environment.setenv("COLUMNS", "80")
        environment.setenv("TERM", "xterm")
        yield
