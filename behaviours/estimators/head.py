"""Whether the head is stuck.

Takes: the state of the head. Gives: stuck or not. Leaves alone: freeing it (competences/un_stick.py).
"""

from __future__ import annotations

from collections.abc import Mapping

from behaviours.interface import Channels, Reading, Report


class HeadWatch:
    """patience [s]: a head that has not come to rest where it was sent for longer is stuck, until it has."""

    def __init__(self, patience: float) -> None:
        self.patience = patience
        self.is_stuck = False
        self._settled = 0.0

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        head = reading.head
        if head is None or head.settled:
            self._settled = reading.stamp
        self.is_stuck = reading.stamp - self._settled > self.patience
