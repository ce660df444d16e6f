"""Whether the tracks labour, and where the flippers are.

Takes: every reading with motor currents and the state of the flippers. Gives: what the library `flippers` asks. Leaves
alone: moving the flippers.
"""

from __future__ import annotations

from collections.abc import Mapping

from behaviours.cores.flippers import Labour, LabourSettings
from behaviours.interface import Channels, Reading, Report


class FlipperWatch:
    """labour: the state machine; are_out: the flippers bear on the ground."""

    def __init__(self, settings: LabourSettings) -> None:
        self.settings = settings
        self.labour = Labour(settings)
        self.are_out = False

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        drawn = reading.currents
        if drawn is not None and drawn.fresh:
            self.labour.take(drawn.stamp, drawn.left, drawn.right)
        if reading.flippers is not None:
            self.are_out = reading.flippers.deployed
