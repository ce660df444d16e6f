"""Readings as JSON text and back, to the last bit.

Takes: `Reading`s one after the other. Gives: for each a JSON text, and from such texts equal readings again.
Leaves alone: where the texts are kept.

A text gives of each sensor only the fields that changed since the text before it, so that bearings and ranges are not
repeated: an empty object stands for a sensor that says what it said, a missing one for a sensor that is not carried.
Hence the texts are read from the first on, in order. Numbers have all their digits; NaN is null, infinite numbers are
the texts "inf" and "-inf"; arrays are base64 of their 8-byte floats (little endian) or of their bytes (bool).
"""

from __future__ import annotations

import json
import math
from base64 import b64decode, b64encode
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, fields
from operator import attrgetter
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from behaviours.interface import (
    Battery,
    Bumper,
    Compass,
    Currents,
    Fix,
    FlipperState,
    HeadState,
    Imu,
    Inclination,
    IrReading,
    Odometry,
    Pose,
    Ranges,
    Reading,
    Scan,
    Sensed,
    StereoReading,
)

SENSORS: Mapping[str, type[Sensed]] = {
    "odometry": Odometry,
    "sonar": Ranges,
    "skirt": Ranges,
    "head": HeadState,
    "ir": IrReading,
    "stereo": StereoReading,
    "lidar": Scan,
    "compass": Compass,
    "imu": Imu,
    "inclination": Inclination,
    "gps": Fix,
    "currents": Currents,
    "bumper": Bumper,
    "flippers": FlipperState,
    "battery": Battery,
}
"""Field of a Reading -> the kind of sensor in it."""

KINDS: Mapping[str, type[Sensed]] = {kind.__name__: kind for kind in get_args(Sensed)}
FIELDS = {kind: tuple(field.name for field in fields(kind)) for kind in KINDS.values()}
VALUES: Mapping[type[Sensed], Callable[[Sensed], tuple[object, ...]]] = {
    kind: attrgetter(*names) for kind, names in FIELDS.items()
}
_sensors = attrgetter(*SENSORS)

_encode = json.JSONEncoder(separators=(",", ":"), check_circular=False, allow_nan=False).encode
Parts = dict[str, object]


# --- writing --------------------------------------------------------------------------------------


def _number(value: float) -> object:
    if math.isfinite(value):
        return value
    return None if math.isnan(value) else str(value)


def _plain(value: object) -> object:
    match value:
        case float():
            return _number(value)
        case bool() | int() | str():
            return value
        case np.bool_():
            return bool(value)
        case np.ndarray():
            return b64encode((value if value.dtype == bool else value.astype("<f8")).tobytes()).decode("ascii")
        case Pose(x, y, theta):
            return [_number(x), _number(y), _number(theta)]
        case tuple():
            return [_number(number) for number in value]
        case _:
            raise TypeError(f"a reading does not hold {value!r}")


@dataclass(frozen=True, slots=True)
class _Said:
    """A sensor, and the values of its fields."""

    sensed: Sensed
    values: tuple[object, ...]


def _changed(said: _Said, before: _Said | None) -> Parts:
    """The fields that differ from what the sensor said before; all where it said nothing or was of another kind."""
    kind = type(said.sensed)
    if before is None or type(before.sensed) is not kind:
        return {name: _plain(value) for name, value in zip(FIELDS[kind], said.values, strict=True)}
    parts: Parts = {}
    for name, value, old in zip(FIELDS[kind], said.values, before.values, strict=True):
        if value is not old and (type(value) is np.ndarray or value != old):
            parts[name] = _plain(value)
    return parts


class ReadingTexts:
    """Puts the readings of one run into texts; each is written against the one before."""

    def __init__(self) -> None:
        self._before: dict[str, _Said] = {}

    def text(self, reading: Reading) -> str:
        """The JSON text of the next reading."""
        now: dict[str, _Said] = {}
        on_board = reading.object_on_board
        parts: Parts = {"tick": reading.tick, "stamp": _number(reading.stamp), "object_on_board": on_board}
        for name, sensed in zip(SENSORS, _sensors(reading), strict=True):
            if sensed is not None:
                parts[name] = self._changes(name, sensed, now)
        if reading.others:
            parts["others"] = {
                name: {"kind": type(sensed).__name__, **self._changes(f"others/{name}", sensed, now)}
                for name, sensed in reading.others.items()
            }
        self._before = now
        return _encode(parts)

    def _changes(self, key: str, sensed: Sensed, now: dict[str, _Said]) -> Parts:
        before = self._before.get(key)
        if before is not None and sensed is before.sensed:
            now[key] = before
            return {}
        now[key] = said = _Said(sensed, VALUES[type(sensed)](sensed))
        return _changed(said, before)


# --- reading --------------------------------------------------------------------------------------


def _to_number(value: Any) -> float:
    if value is None:
        return math.nan
    if isinstance(value, int | float | str) and not isinstance(value, bool):
        return float(value)
    raise ValueError(f"expected a number, got {value!r}")


def _to_floats(value: Any) -> NDArray[np.float64]:
    return np.frombuffer(b64decode(value, validate=True), dtype="<f8").astype(np.float64)


def _to_bools(value: Any) -> NDArray[np.bool_]:
    return np.frombuffer(b64decode(value, validate=True), dtype=np.uint8).astype(np.bool_)


def _to_pose(value: Any) -> Pose:
    x, y, theta = map(_to_number, value)
    return Pose(x, y, theta)


def _to_pair(value: Any) -> tuple[float, float]:
    x, y = map(_to_number, value)
    return x, y


FROM_PLAIN: Mapping[str, Callable[[Any], object]] = {
    "float": _to_number,
    "bool": bool,
    "str": str,
    "Floats": _to_floats,
    "NDArray[np.bool_]": _to_bools,
    "Pose": _to_pose,
    "Vec2": _to_pair,
}
"""Type of a field -> how it comes back."""

TYPES = {kind: {field.name: FROM_PLAIN[str(field.type)] for field in fields(kind)} for kind in KINDS.values()}


@dataclass(slots=True)
class _Sensors:
    """What every sensor said last, by its place in the reading."""

    values: dict[str, dict[str, Any]]
    sensed: dict[str, Sensed]

    def take(self, key: str, kind: type[Sensed], parts: Mapping[str, Any]) -> Sensed:
        """The sensor after these changes."""
        known = self.sensed.get(key)
        if known is not None and type(known) is kind and not parts:
            return known
        values = self.values[key] if known is not None and type(known) is kind else {}
        self.values[key] = values | {name: TYPES[kind][name](value) for name, value in parts.items()}
        self.sensed[key] = made = kind(**self.values[key])
        return made

    def forget(self, carried: Iterable[str]) -> None:
        """A sensor that is not there now starts anew when it comes back."""
        keep = set(carried)
        for key in [key for key in self.sensed if key not in keep]:
            del self.sensed[key], self.values[key]


def _reading(parts: Mapping[str, Any], sensors: _Sensors) -> Reading:
    carried = {name: sensors.take(name, kind, parts[name]) for name, kind in SENSORS.items() if name in parts}
    others: dict[str, Sensed] = {}
    for name, given in parts.get("others", {}).items():
        changes = {field: value for field, value in given.items() if field != "kind"}
        others[name] = sensors.take(f"others/{name}", KINDS[given["kind"]], changes)
    sensors.forget([*carried, *(f"others/{name}" for name in others)])
    fixed: dict[str, Any] = dict(carried)
    if others:
        fixed["others"] = others
    stamp, on_board = _to_number(parts["stamp"]), bool(parts["object_on_board"])
    return Reading(stamp=stamp, tick=int(parts["tick"]), object_on_board=on_board, **fixed)


def readings(texts: Iterable[bytes | str]) -> Iterator[Reading]:
    """The readings that these texts give, from the first on. Raises ValueError where a text is not one of them."""
    sensors = _Sensors({}, {})
    for number, text in enumerate(texts):
        try:
            yield _reading(json.loads(text), sensors)
        except (KeyError, TypeError, AttributeError, ValueError) as fault:
            raise ValueError(f"reading {number} is not whole: {fault!r}") from fault
