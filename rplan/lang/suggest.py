"""Which name was meant (L6).

Takes: a name and the names that exist. Gives: the one that is close to it, if any. Leaves alone: which names exist.
"""

from __future__ import annotations

from collections.abc import Iterable

SHORTEST = 5


def close(name: str, candidates: Iterable[str], shortest: int = SHORTEST) -> str | None:
    """The first of the candidates that is one slip away from name; None if there is none, or if name is a candidate.

    A slip is one letter (not a digit) inserted, dropped or changed, or two neighbours swapped. Both names have at
    least `shortest` characters.
    """
    names = list(candidates)
    if len(name) < shortest or name in names:
        return None
    return next((other for other in names if len(other) >= shortest and _one_slip(name, other)), None)


class Names:
    """Names that are asked for many times: as `close`, at a cost that does not grow with their number."""

    def __init__(self, names: Iterable[str]) -> None:
        self._names = [*dict.fromkeys(names)]
        self._known = frozenset(self._names)
        self._by_rest: dict[str, list[int]] = {}
        for number, name in enumerate(self._names):
            if len(name) >= SHORTEST:
                for rest in _rests(name):
                    self._by_rest.setdefault(rest, []).append(number)

    def close(self, name: str) -> str | None:
        """The first of the names that is one slip away from name."""
        if len(name) < SHORTEST or name in self._known:
            return None
        near = {number for rest in _rests(name) for number in self._by_rest.get(rest, ())}
        return next((self._names[number] for number in sorted(near) if _one_slip(name, self._names[number])), None)


def _rests(name: str) -> list[str]:
    """The name, and what is left of it without one of its characters: names one slip apart share one of these."""
    return [name, *(name[:place] + name[place + 1 :] for place in range(len(name)))]


def _one_slip(a: str, b: str) -> bool:
    if abs(len(a) - len(b)) > 1 or a == b:
        return False
    start = next((i for i, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), min(len(a), len(b)))
    rest_a, rest_b = a[start:], b[start:]
    if len(a) != len(b):
        longer, shorter = (rest_a, rest_b) if len(a) > len(b) else (rest_b, rest_a)
        return longer[1:] == shorter and _letters(longer[0])
    changed = rest_a[1:] == rest_b[1:] and _letters(rest_a[0] + rest_b[0])
    swapped = rest_a[:2] == rest_b[1::-1] and rest_a[2:] == rest_b[2:] and _letters(rest_a[:2])
    return changed or swapped


def _letters(text: str) -> bool:
    return not any(character.isdigit() for character in text)
