"""The loops of the caster in C, where the machine has a compiler.

Takes: `raycast.c`, which lies beside this file. Gives: `loops()`, compiled once and kept in the user's cache, or None
where there is no compiler or no cffi; everything works without, more slowly, with the same bits.
Leaves alone: what the arrays mean (`raycast.py`).

The library is named by a hash of source and flags. No flag lets the compiler change the order of operations.
"""

from __future__ import annotations

import functools
import hashlib
import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

SOURCE = Path(__file__).with_name("raycast.c")
COMPILERS = ("cc", "gcc", "clang")
FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fno-math-errno", "-fPIC", "-shared")
BUCKETS = 1024
Array = NDArray[Any]


class Loops:
    """The compiled functions, over arrays; a struct that is given keeps the arrays that it points into alive."""

    def __init__(self, library: Path, source: str) -> None:
        from cffi import FFI

        self._ffi = FFI()
        self._ffi.cdef(_declarations(source))
        self._library = self._ffi.dlopen(str(library))

    def struct(self, kind: str, numbers: dict[str, float | int], arrays: dict[str, Array]) -> tuple[Any, Any]:
        """A struct of the source, and what has to live as long as it does."""
        made = self._ffi.new(f"struct {kind} *", numbers)
        buffers = {name: self._ffi.from_buffer(array) for name, array in arrays.items()}
        for name, buffer in buffers.items():
            setattr(made, name, self._ffi.cast("void *", buffer))
        return made, (buffers, arrays)

    def place(self, scene: Any, first: int, last: int, x: float, y: float, c: float, s: float) -> None:
        """Edges [first, last) from the frame of a thing at (x, y), cosine c and sine s of its heading, to the world."""
        self._library.rplan_place(scene, first, last, x, y, c, s)

    def sweep(
        self, scene: Any, area: Any, fan: Any, pose: tuple[float, float, float, float], max_range: float, count: int
    ) -> tuple[Array, Array]:
        """Ranges and things; pose: x, y, and cosine and sine of the heading."""
        ranges, things = np.empty(count), np.empty(count, dtype=np.int64)
        at, view = self._ffi.from_buffer, np.empty(2 * count)
        self._library.rplan_sweep(
            scene, area, fan, *pose, max_range, at("double[]", view), at("double[]", ranges), at("int64_t[]", things)
        )
        return ranges, things

    def cast(self, scene: Any, area: Any, rays: Any, max_range: float, count: int) -> tuple[Array, Array]:
        """Ranges and things."""
        ranges, things = np.empty(count), np.empty(count, dtype=np.int64)
        order, before = np.empty(4 * count, dtype=np.int64), np.empty(2 * BUCKETS + 4, dtype=np.int64)
        at = self._ffi.from_buffer
        self._library.rplan_cast(
            scene,
            area,
            rays,
            max_range,
            *(at("int64_t[]", array) for array in (order, before)),
            at("double[]", ranges),
            at("int64_t[]", things),
        )
        return ranges, things


def order_of(cos: Array, sin: Array) -> tuple[Array, Array]:
    """Rays by buckets of their pseudo-angle, four turns of them, and where each bucket begins: as `raycast.c` says."""
    part = sin / (np.abs(cos) + np.abs(sin))
    turn = np.where(cos >= 0, np.where(part >= 0, part, 4 + part), 2 - part)
    bucket = np.clip((turn * (BUCKETS // 4)).astype(np.int64), 0, BUCKETS - 1)
    begins = np.searchsorted(np.sort(bucket), np.arange(BUCKETS))
    places = np.arange(-1, 2 * BUCKETS + 3)
    before = begins[places % BUCKETS] + bucket.size * (1 + places // BUCKETS)
    return np.tile(np.argsort(bucket, kind="stable"), 4).astype(np.int64), before.astype(np.int64)


@functools.cache
def loops() -> Loops | None:
    """The compiled loops; None where they cannot be had."""
    return compiled() if np.dtype(np.intp).itemsize == 8 else None


def compiled(folder: Path | None = None) -> Loops | None:
    """The loops from a library in `folder` (by default the user's cache), compiled if it is not there."""
    try:
        folder = _cache() if folder is None else folder
        source = SOURCE.read_text(encoding="ascii")
        key = hashlib.sha256("\n".join((*FLAGS, source)).encode()).hexdigest()[:32]
        path = folder / f"rays-{key}.so"
        if not path.exists():
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(dir=folder) as scratch:
                _compile(Path(scratch) / "rays.so").replace(path)
        return Loops(path, source)
    except (ImportError, OSError, RuntimeError, subprocess.SubprocessError):
        return None


def _cache() -> Path:
    base = Path(os.environ.get("XDG_CACHE_HOME", ""))
    return (base if base.is_absolute() else Path.home() / ".cache") / "rplan" / "sim"


def _compile(target: Path) -> Path:
    compiler = next((found for name in COMPILERS if (found := shutil.which(name))), None)
    if compiler is None:
        raise OSError("no C compiler")
    command = [compiler, *FLAGS, "-o", str(target), str(SOURCE), "-lm"]
    subprocess.run(command, capture_output=True, check=True, stdin=subprocess.DEVNULL, timeout=60)
    return target


def _declarations(source: str) -> str:
    """Structs and the functions that are not static, without their bodies."""
    structs = re.findall(r"^struct \w+ \{\n.*?^\};", source, re.M | re.S)
    functions = [f"{head};" for head in re.findall(r"^void rplan_\w+\([^{]*?\)(?=\n\{)", source, re.M | re.S)]
    return "\n".join((*structs, *functions))
