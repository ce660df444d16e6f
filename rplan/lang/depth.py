"""How deeply plans may nest, room on the stack to walk that deep, and quiet to build large ones.

Takes: nothing. Gives: `MAX_LEVELS`, `deep_recursion`, `no_collection`. Leaves alone: the walking.
"""

from __future__ import annotations

import gc
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


@contextmanager
def no_collection() -> Iterator[None]:
    """Without the collector of cycles: a long plan makes a million objects and no cycle, and reads twice as fast."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()
