"""Files that are imported: read within bounds, whatever somebody put into them.

Takes: paths. Gives: bytes, texts, JSON values, and grey pictures as arrays. Raises WorldFileError where a file is
missing, too large, broken or not what it should be. Leaves alone: what they mean.
"""

from __future__ import annotations

import gzip
import io
import json
import warnings
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

from sim.scenarios.grid import MOST_CELLS
from sim.scenarios.importers.imported import Options, WorldFileError, number, shown

MOST_BYTES = 128 * 2**20
MOST_UNPACKED = 256 * 2**20
MOST_ITEMS = 100_000
PICTURES = ("PNG", "PPM", "BMP", "GIF", "JPEG")
Grey = NDArray[np.uint8] | NDArray[np.float32]


def read_bytes(path: Path, most: int = MOST_BYTES) -> bytes:
    """What is in a file. Raises WorldFileError."""
    try:
        if not path.is_file():
            raise WorldFileError(path.name, 0, "there is no such file")
        size = path.stat().st_size
        if size > most:
            raise WorldFileError(path.name, 0, f"the file has {size:,} bytes; at most {most:,} are read")
        return path.read_bytes()
    except (OSError, ValueError) as fault:
        reason = fault.strerror if isinstance(fault, OSError) else str(fault)
        raise WorldFileError(path.name, 0, f"the file cannot be read: {reason}") from fault


def read_text(path: Path, most: int = MOST_BYTES) -> str:
    """The text in a file, without the mark that some editors put first. Raises WorldFileError."""
    return decoded(read_bytes(path, most), path.name)


def decoded(data: bytes, file: str) -> str:
    """The text. Raises WorldFileError."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as fault:
        line = data.count(b"\n", 0, fault.start) + 1
        raise WorldFileError(file, line, "not a text in UTF-8") from fault
    if not text.strip():
        raise WorldFileError(file, 0, "the file is empty")
    return text


def unpacked(data: bytes, file: str) -> bytes:
    """What gzip packed, or the data as they are. Raises WorldFileError."""
    if data[:2] != b"\x1f\x8b":
        return data
    try:
        with gzip.GzipFile(fileobj=io.BytesIO(data)) as stream:
            whole = stream.read(MOST_UNPACKED + 1)
    except (OSError, EOFError, zlib.error) as fault:
        raise WorldFileError(file, 0, f"the packed file is damaged: {fault}") from fault
    if len(whole) > MOST_UNPACKED:
        raise WorldFileError(file, 0, f"the file unpacks to more than {MOST_UNPACKED:,} bytes")
    return whole


def read_json(path: Path) -> dict[str, Any]:
    """The mapping in a JSON file. Raises WorldFileError."""
    text = read_text(path)
    try:
        value = json.loads(text)
    except json.JSONDecodeError as fault:
        raise WorldFileError(path.name, fault.lineno, f"not JSON: {fault.msg}") from fault
    except (RecursionError, ValueError) as fault:
        raise WorldFileError(
            path.name, 0, "not JSON that can be read: too deep, or a number of too many digits"
        ) from fault
    if not isinstance(value, dict):
        raise WorldFileError(path.name, 0, f"expected a mapping, got {shown(value)}")
    return value


def listed(value: object, file: str, what: str) -> list[Any]:
    """The value as a list of at least one. Raises WorldFileError."""
    if not isinstance(value, list) or not value:
        raise WorldFileError(file, 0, f"{what}: expected a list, got {shown(value)}")
    if len(value) > MOST_ITEMS:
        raise WorldFileError(file, 0, f"{what}: {len(value):,} are too many; at most {MOST_ITEMS:,} are read")
    return value


def numbers(value: object, file: str, what: str, count: int) -> list[float]:
    """The value as a list of so many numbers; more may follow. Raises WorldFileError."""
    items = listed(value, file, what)
    if len(items) < count:
        raise WorldFileError(file, 0, f"{what}: expected {count} numbers, got {len(items)}")
    return [number(item, file, f"{what}[{index}]") for index, item in enumerate(items[:count])]


def asked_world(options: Options, known: list[int], file: str) -> int:
    """Which of the worlds in the file is meant: the one asked for, or the first. Raises WorldFileError."""
    if options.world is None:
        return known[0]
    if options.world not in known:
        some = ", ".join(map(str, known[:8])) + (", …" if len(known) > 8 else "")
        raise WorldFileError(file, 0, f"there is no world {options.world} in it; there are {len(known)}: {some}")
    return options.world


def read_picture(path: Path) -> Grey:
    """Grey values 0 to 255, (rows, columns), row 0 at the top, in whole numbers where the picture has those.

    NaN where it is transparent.

    Raises WorldFileError, before anything of its size is allocated where it has more cells than grids may have.
    """
    data = read_bytes(path)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with Image.open(io.BytesIO(data), formats=PICTURES) as picture:
                if picture.width * picture.height > MOST_CELLS:
                    size = f"{picture.width:,} x {picture.height:,}"
                    raise WorldFileError(path.name, 0, f"the picture has {size} cells; at most {MOST_CELLS:,} are read")
                return _grey(picture)
    except WorldFileError:
        raise
    except Image.DecompressionBombError as fault:
        raise WorldFileError(
            path.name, 0, f"the picture has too many cells; at most {MOST_CELLS:,} are read"
        ) from fault
    except UnidentifiedImageError as fault:
        known = ", ".join(PICTURES)
        raise WorldFileError(path.name, 0, f"not a picture that can be read; expected one of {known}") from fault
    except Exception as fault:  # decoders of broken pictures raise whatever they run into
        reason = " ".join(str(fault).split())[:80] or type(fault).__name__
        raise WorldFileError(path.name, 0, f"not a picture that can be read ({reason})") from fault


def _grey(picture: Image.Image) -> Grey:
    if picture.mode in ("1", "L"):
        return np.asarray(picture.convert("L"), dtype=np.uint8)
    if picture.mode.startswith(("I", "F")):
        deep: NDArray[np.float32] = np.array(picture, dtype=np.float32)
        deep *= np.float32(255 / 65535)
        return deep
    if "A" in picture.mode or "a" in picture.mode or "transparency" in picture.info:
        channels = np.asarray(picture.convert("RGBA"), dtype=np.uint8)
        grey: NDArray[np.float32] = np.array(channels[:, :, :3].mean(axis=2, dtype=np.float32))
        grey[channels[:, :, 3] < 255] = np.nan
        return grey
    channels = np.asarray(picture.convert("RGB"), dtype=np.uint8)
    return np.asarray(channels.mean(axis=2, dtype=np.float32), dtype=np.float32)
