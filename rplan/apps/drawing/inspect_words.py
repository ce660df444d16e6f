"""What a register is called where a person reads.

Takes: its name in the circuit. Gives: words. Leaves alone: the circuit, whose names programs keep.
"""

from __future__ import annotations


def register_words(name: str) -> str:
    """A bit of a counter says which bit it is: `(held-for 0.2s (near))#0` is `(held-for 0.2s (near)), bit 0`."""
    text, mark, place = name.rpartition("#")
    return f"{text}, bit {place}" if mark and text.endswith(")") and place.isdigit() else name
