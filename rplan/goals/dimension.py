"""Dimensions of products and quotients.

Takes: SI units as the language writes them ("m", "m/s", "" for none). Gives: the unit of a product or quotient in the
same spelling. Leaves alone: sums, whose parts must be of one dimension.
"""

from __future__ import annotations

from collections.abc import Mapping


def product(a: str, b: str) -> str:
    """The unit of a product: "m/s" times "s" is "m"."""
    return _spelled(_sum(_powers(a), _powers(b), 1))


def quotient(a: str, b: str) -> str:
    """The unit of a quotient: "m" by "s" is "m/s"."""
    return _spelled(_sum(_powers(a), _powers(b), -1))


def _sum(a: Mapping[str, int], b: Mapping[str, int], sign: int) -> dict[str, int]:
    return {name: a.get(name, 0) + sign * b.get(name, 0) for name in (*a, *b)}


def _powers(unit: str) -> dict[str, int]:
    """Unit -> its power: "m^2/s" has m: 2 and s: -1."""
    powers: dict[str, int] = {}
    above, *below = unit.split("/")
    for sign, part in [(1, above), *((-1, one) for one in below)]:
        for factor in filter(None, part.split("*")):
            name, _, power = factor.partition("^")
            if name != "1":
                powers[name] = powers.get(name, 0) + sign * int(power or 1)
    return powers


def _spelled(powers: Mapping[str, int]) -> str:
    def one(name: str, power: int) -> str:
        return name if power == 1 else f"{name}^{power}"

    above = "*".join(one(name, power) for name, power in sorted(powers.items()) if power > 0)
    below = "".join(f"/{one(name, -power)}" for name, power in sorted(powers.items()) if power < 0)
    return f"{above or '1'}{below}" if below else above
