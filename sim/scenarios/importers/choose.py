"""Which importer a file needs: by its name, and by what is in it.

Takes: a path, and options. Gives: `Imported`, or the whole way to a `Scenario` and its text (`load`).
Leaves alone: logs, which are no worlds (`carmen.py`).
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType

from sim.scenarios.format import loads
from sim.scenarios.importers import barn, dynabarn, micromouse, moving_ai, ros_map, stage, wall_follower
from sim.scenarios.importers.imported import Document, Imported, Options, WorldFileError, printable
from sim.scenarios.importers.sources import decoded, read_bytes, unpacked
from sim.scenarios.importers.written import yaml_text
from sim.scenarios.scenario import Scenario

LOG = "carmen"
READERS: Mapping[str, Callable[[Path, Options], Imported]] = MappingProxyType(
    {
        "barn": barn.read,
        "dynabarn": dynabarn.read,
        "micromouse": micromouse.read,
        "moving-ai": moving_ai.read,
        "picture": ros_map.read_picture_alone,
        "ros-map": ros_map.read,
        "stage": stage.read,
        "wall-follower": wall_follower.read,
    }
)
FORMATS = (*READERS, LOG)
BY_SUFFIX: Mapping[str, str] = MappingProxyType(
    {".world": "stage", ".inc": "stage", ".map": "moving-ai", ".yaml": "ros-map", ".yml": "ros-map", ".log": LOG}
    | dict.fromkeys((".png", ".pgm", ".pbm", ".ppm", ".bmp", ".gif", ".jpg", ".jpeg"), "picture")
    | {".clf": LOG, ".gfs": LOG}
)
LOOKED_AT = 2**16  # bytes from which the content of a file is judged


def split(given: str) -> tuple[Path, int | None]:
    """The file and the number of the world in FILE#3."""
    name, sign, number = given.rpartition("#")
    if sign and number.isascii() and number.isdigit() and len(number) < 10 and not Path(given).exists():
        return Path(name), int(number)
    return Path(given), None


def format_of(path: Path) -> str:
    """The name of the format of a file. Raises WorldFileError where it is none that is known."""
    name = path.name[:-3] if path.suffix.lower() == ".gz" else path.name
    suffix = Path(name).suffix.lower()
    data = read_bytes(path)
    if suffix == ".json":
        return _json_format(path.name, data)
    if suffix in BY_SUFFIX:
        return BY_SUFFIX[suffix]
    if data[:2] == b"\x1f\x8b":
        data = unpacked(data, path.name)
    if (found := _by_content(data[:LOOKED_AT])) is None:
        raise WorldFileError(path.name, 0, f"this is no format that is known; there are {', '.join(FORMATS)}")
    return found


def _json_format(file: str, data: bytes) -> str:
    try:
        value = json.loads(decoded(data, file))
    except (ValueError, RecursionError):
        return "barn"  # whose reader says what is wrong with it
    keys = value if isinstance(value, dict) else {}
    if "trajectories" in keys:
        return "dynabarn"
    if "tests" in keys:
        return "wall-follower"
    if "worlds" in keys or "cylinders" in keys:
        return "barn"
    expected = "worlds or cylinders (barn), trajectories (dynabarn), or tests and map (wall-follower)"
    raise WorldFileError(file, 0, f"this JSON is no world that is known: expected {expected}")


def _by_content(data: bytes) -> str | None:
    text = data.decode("utf-8", "replace").lstrip("\ufeff \r\n\t")
    if data[:4] in (b"\x89PNG", b"GIF8") or data[:2] in (b"P5", b"P2", b"P4", b"BM"):
        return "picture"
    if text.startswith(("o---", "o   ", "+---")):
        return "micromouse"
    if text.startswith("type ") and "\nmap" in text:
        return "moving-ai"
    lines = text.splitlines()
    if any(line.startswith(("FLASER ", "ROBOTLASER1 ", "ODOM ", "PARAM ")) for line in lines):
        return LOG
    if any(line.startswith("resolution:") for line in lines):
        return "ros-map"
    return "stage" if any(line.startswith(("include ", "define ")) for line in lines) else None


def read(path: Path, options: Options) -> Imported:
    """The world in a file as a document that says where it came from. Raises WorldFileError."""
    form = options.format or format_of(path)
    if form == LOG:
        raise WorldFileError(path.name, 0, "this is a log, not a world: import it as a recording (-o FILE.mcap)")
    if form not in READERS:
        raise WorldFileError(path.name, 0, f"there is no format {form!r}; there are {', '.join(FORMATS)}")
    imported = READERS[form](path, options)
    return replace(imported, document=_signed(imported, path, form))


def _signed(imported: Imported, path: Path, form: str) -> Document:
    """The document with its source, and what was left out."""
    texts = [printable(text, 500).strip() for text in imported.left_out]
    name = printable(str(imported.document["name"]), 100).strip()
    signed = imported.document | {"name": name or form, "source": printable(f"{path.name} ({form})")}
    return signed | ({"left_out": texts} if texts else {})


def text_of(imported: Imported) -> str:
    """The document as YAML with remarks on where it is from and what is not in it."""
    source = imported.document["source"]
    left_out = imported.document.get("left_out", [])
    return yaml_text(imported.document, (f"Imported from {source}.", *(f"Left out: {text}" for text in left_out)))


def load(path: Path, options: Options) -> tuple[Scenario, str]:
    """The scenario in a file of another format, and its text as YAML. Raises WorldFileError and ScenarioError."""
    text = text_of(read(path, options))
    return loads(text, path.name), text


@dataclass(frozen=True, slots=True)
class Summary:
    """How much there is in a world."""

    things: int
    discs: int
    rings: int
    vertices: int
    sensors: int


def summary(document: Document) -> Summary:
    """Count what is in a document."""
    things = document.get("things", [])
    rings = [ring for thing in things for ring in thing.get("rings", ())]
    corners = sum(ring.count(",") + 1 for ring in rings)
    boxes = sum(thing["kind"] in ("box", "wall") for thing in things)
    discs = sum(thing["kind"] == "disc" for thing in things)
    sensors = len(document["robot"].get("sensors", ()))
    return Summary(len(things), discs, len(rings) + boxes, corners + 4 * boxes, sensors)
