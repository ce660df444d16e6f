"""The search for the range of what stands in a direction.

Takes: stereo fixations, the reports of the two competences that move the head, and the direction to search in. Gives:
how far the search is, where to look next, the range once found. Leaves alone: moving the head; what the range is for.
A search whose competences lose their turn is dropped: the next one starts from scratch.

With `from_horizon` it looks along the ground from far to near and passes over what does not fit the strength of the
beacon, so that what stands between robot and donor is not taken for the donor.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal

from behaviours.cores.ground import GroundSettings, ground_points, off_the_ground, pans, sigma, tilt
from behaviours.interface import Channels, Head, Pose, Reading, Report, StereoReading, wrap

Phase = Literal["idle", "running", "done"]
START, CONTINUE = "start-stereo-ranging", "continue-stereo-search"


@dataclass(frozen=True, slots=True)
class StereoSettings:
    """camera_height [m]: until a reading tells it; angle_tolerance [rad]; times [s]; looks, unsticks: counts.

    A discontinuity is believed when `looks` fixations at one place agree on it: what passes by is not an object.
    from_horizon: look from far to near, for what lies within `reach_slack` [m] and `reach_share` of the distance that
    the beacon's signal tells.
    """

    ground: GroundSettings = field(default_factory=GroundSettings)
    camera_height: float = 1.2
    angle_tolerance: float = math.radians(0.5)
    looks: int = 2
    fixation_timeout: float = 20.0
    unsticks: int = 3
    unstick_time: float = 3.0
    reach_slack: float = 0.5
    reach_share: float = 0.08
    from_horizon: bool = False


@dataclass(frozen=True, slots=True)
class Found:
    """ground [m]: distance to what was found, bearing [rad] of the ray, place of the robot; in the odometry frame.

    envelope [m]: how far the distance may be off by the errors that are accounted for.
    """

    place: Pose
    bearing: float
    ground: float
    envelope: float = 0.0


class StereoSearch:
    """One search along the ground. bearing: where to search [rad, odometry frame], None: straight ahead.

    reach: how far [m] the beacon's middle is by its signal, None or NaN where that is not known.
    """

    def __init__(
        self,
        settings: StereoSettings,
        bearing: Callable[[], float | None],
        reach: Callable[[], float | None] = lambda: None,
    ) -> None:
        self.settings = settings
        self.phase: Phase = "idle"
        self.found: Found | None = None
        self.reason = ""
        self._bearing, self._reach = bearing, reach
        self._height = settings.camera_height
        self._fixations: tuple[Head, ...] = ()
        self._restart(0.0)

    def update(self, reading: Reading, reports: Mapping[str, Report], channels: Channels) -> None:
        if reading.stereo is not None:
            self._height = reading.stereo.camera_height
        if START in reports:
            self._fixations = self._plan(reading)
            self.phase = "running"
            self.found = None
            self._restart(reading.stamp)
        elif self.phase == "running" and CONTINUE not in reports:
            self.forget()
        if self.phase == "running":
            self._take(reading)

    def forget(self) -> None:
        """Drop the search and its result."""
        self.phase = "idle"
        self.found = None

    def is_started(self) -> bool:
        """Whether a search is going on or has come to its end."""
        return self.phase != "idle"

    def is_finished(self) -> bool:
        """Whether it has come to its end."""
        return self.phase == "done"

    def is_no_good(self) -> bool:
        """Whether it has come to its end without a range within the cut-off."""
        return self.phase == "done" and self.found is None

    def needs_help(self) -> bool:
        """Whether the head has been freed in vain, so that only a person can help."""
        return self._unsticks >= max(3, self.settings.unsticks) and self.phase != "idle"

    def range_found(self) -> float:
        """Distance [m] of what was found; 0 where nothing is."""
        return 0.0 if self.found is None else self.found.ground

    def envelope(self) -> float:
        """How far [m] that distance may be off; 0 where nothing is found."""
        return 0.0 if self.found is None else self.found.envelope

    def first_look(self, reading: Reading) -> Head:
        """Where a search begins."""
        return self._plan(reading)[0]

    def look(self, reading: Reading) -> Head:
        """Where to look now; while the head is being freed level, and from the second time on straight ahead."""
        wanted = self._fixations[min(self._index, len(self._fixations) - 1)]
        if reading.stamp >= self._freeing_until:
            return wanted
        return Head(wanted.pan if self._unsticks <= 1 else 0.0, 0.0)

    def progress(self) -> dict[str, object]:
        """For reports: the envelope [m] is that of an object where the ray meets the ground."""
        told: dict[str, object] = {
            "fixation": self._index,
            "of": len(self._fixations),
            "unsticks": self._unsticks,
        }
        if self._index < len(self._fixations):
            tilted = self._fixations[self._index].tilt
            slant = self._height / math.sin(tilted)
            told["ground"] = round(slant * math.cos(tilted), 2)
            told["envelope"] = round(self._envelope_at(slant, tilted), 2)
        return told | ({"asks": "a helpful tap at the head"} if self.needs_help() else {})

    def last_result(self) -> dict[str, object]:
        """How the search before came to its end, for the report of the next."""
        return {"failed": self.reason} if self.is_no_good() else {}

    def _plan(self, reading: Reading) -> tuple[Head, ...]:
        """Every fixation, near to far, or from the horizon down."""
        bearing = self._bearing()
        ahead = 0.0 if bearing is None else wrap(bearing - reading.odometry.pose.theta)
        offsets = pans(self.settings.ground)
        points = ground_points(self._height, self.settings.ground)
        along = points[::-1] if self.settings.from_horizon else points
        return tuple(Head(ahead + offset, tilt(self._height, at)) for at in along for offset in offsets)

    def _restart(self, stamp: float) -> None:
        self._index = 0
        self._unsticks = 0
        self._freeing_until = -math.inf
        self._look_again(stamp)

    def _look_again(self, stamp: float) -> None:
        self._since = stamp
        self._blind = 0
        self._seen: tuple[float, ...] = ()

    def _take(self, reading: Reading) -> None:
        stereo, wanted = reading.stereo, self._fixations[self._index]
        if stereo is not None and stereo.fresh and self._looks_at(stereo, wanted):
            self._since = reading.stamp
            self._judge(stereo, reading)
        elif reading.stamp - self._since > self.settings.fixation_timeout:
            self._free_head(reading)

    def _looks_at(self, stereo: StereoReading, wanted: Head) -> bool:
        tolerance = self.settings.angle_tolerance
        return abs(wrap(stereo.pan - wanted.pan)) <= tolerance and abs(stereo.tilt - wanted.tilt) <= tolerance

    def _judge(self, stereo: StereoReading, reading: Reading) -> None:
        if math.isnan(stereo.range) and self._blind == 0:
            self._blind = 1
        elif off_the_ground(stereo.range, stereo.camera_height, stereo.tilt, self.settings.ground):
            self._believe(stereo, reading)
        else:
            self._advance(reading)

    def _believe(self, stereo: StereoReading, reading: Reading) -> None:
        """Take one more look at a discontinuity; what does not stay where it is is passed over."""
        spread = 2 * self.settings.ground.error_factor * sigma(stereo.range, self.settings.ground)
        if any(abs(stereo.range - z) > spread for z in self._seen):
            self._advance(reading)
            return
        self._seen = (*self._seen, stereo.range)
        if len(self._seen) < self.settings.looks:
            return
        ground = sum(self._seen) / len(self._seen) * math.cos(stereo.tilt)
        if self.settings.from_horizon and not self._fits(ground):
            self._advance(reading)
        else:
            self._finish(stereo, ground, reading.odometry.pose)

    def _fits(self, ground: float) -> bool:
        """Whether something at this distance [m] may carry the beacon."""
        s, reach = self.settings, self._reach()
        if reach is None or math.isnan(reach):
            return ground <= s.ground.cut_off
        return abs(reach - ground) <= s.reach_slack + s.reach_share * reach

    def _envelope_at(self, slant: float, tilted: float) -> float:
        ground = self.settings.ground
        return ground.error_factor * sigma(slant, ground) * math.cos(tilted)

    def _finish(self, stereo: StereoReading, ground: float, pose: Pose) -> None:
        self.phase = "done"
        self.reason = "" if ground <= self.settings.ground.cut_off else "beyond the cut-off"
        if not self.reason:
            envelope = self._envelope_at(ground / math.cos(stereo.tilt), stereo.tilt)
            self.found = Found(pose, wrap(pose.theta + stereo.pan), ground, envelope)

    def _advance(self, reading: Reading) -> None:
        self._index += 1
        self._look_again(reading.stamp)
        if self._index == len(self._fixations):
            self.phase, self.reason = "done", "nothing stands there"

    def _free_head(self, reading: Reading) -> None:
        """The head does not get there: lift it and try again; in the end a person has to help."""
        self._unsticks += 1
        if self._unsticks > self.settings.unsticks:
            self.phase, self.reason = "done", "the head sticks: it needs a helpful tap"
        self._freeing_until = reading.stamp + self.settings.unstick_time
        self._look_again(self._freeing_until)
