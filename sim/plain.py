"""Values of recordings, which a file of others or a damaged one may have otherwise than expected.

Takes: plain data as JSON has it. Gives: the part that is wanted, or an empty one. Leaves alone: what it means.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

Json = Mapping[str, object]


def mapping(value: object) -> Json:
    """The value where it is a mapping, otherwise an empty one."""
    return value if isinstance(value, Mapping) else {}


def listed(value: object) -> Sequence[object]:
    """The value where it is a list, otherwise an empty one."""
    return value if isinstance(value, list | tuple) else ()


def number(value: object, otherwise: float = math.nan) -> float:
    """The value where it is a number."""
    return float(value) if isinstance(value, int | float) else otherwise
