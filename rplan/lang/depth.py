"""How deeply plans may nest, and room on the stack to walk that deep.

Takes: nothing. Gives: `MAX_LEVELS` and `deep_recursion`. Leaves alone: the walking.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

MAX_LEVELS = 1_000
"""No form, goal or condition of a `Plan` lies deeper than this."""

_FRAMES = 20_000


@contextmanager
def deep_recursion() -> Iterator[None]:
    """Inside, a function may call itself once a level, by way of a few others, down to `MAX_LEVELS`."""
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(max(before, _FRAMES))
    try:
        yield
    finally:
        sys.setrecursionlimit(before)
