"""Mutated worlds and logs: each is imported or refused with one clear line, never slow, never large.

Run by hand: `python tests/experiments/fuzz_imports.py --files 25000`. Files are the samples of `tests/data/imports` and
those of the folder that RPLAN_DATA names, with bytes changed, dropped, doubled and cut off, and with words exchanged
for others. What is imported must be a sound scenario. Prints how many were imported, how many were refused, the slowest
and the peak of memory; exit code 1 if one raised anything else or took longer than `--most` seconds.
"""

from __future__ import annotations

import argparse
import gzip
import os
import re
import resource
import shutil
import sys
import tempfile
from collections import Counter
from pathlib import Path
from time import perf_counter

import numpy as np

from sim.scenarios.importers import LOG, Options, WorldFileError, format_of, load
from sim.scenarios.importers.carmen import entries

SAMPLES = Path(__file__).parents[1] / "data" / "imports"
LARGEST = 300_000
"""Bytes of a file that are mutated; of larger ones the first so many."""

WORD = re.compile(rb"[A-Za-z_]\w*|[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?|[^\s\w]")
ODD_NUMBERS = tuple(
    word.encode()
    for word in (
        "-1",
        "0",
        "1e-9",
        "0.5",
        "3",
        "90",
        "1000",
        "1e4",
        "99999",
        "1e9",
        "1e308",
        "1e999",
        "nan",
        "-0",
        "9" * 22,
    )
)
ODD_WORDS = tuple(
    word.encode()
    for word in (
        *("(", ")", "[", "]", "{", "}", '"', "'", ":", ",", "#", "define", "include", "model", "position", "ranger"),
        *(
            "sensor",
            "size",
            "pose",
            "bitmap",
            "block",
            "points",
            "boundary",
            "origin",
            "samples",
            "map",
            "null",
            "true",
        ),
        *("width", "o", "---", "|", "S", "\0", "\u2028", "é", "9" * 5000, ".inf", "-3.5"),
    )
)


def sources() -> list[Path]:
    """Every file that can be imported, the samples first."""
    folder = Path(os.environ.get("RPLAN_DATA", SAMPLES))
    patterns = ["stage/*.world", "stage/*.inc", "stage/bitmaps/*.png", "ros_maps/*.*", "mazes/*.txt", "*barn/*.json"]
    patterns += ("mit_wall_follower/*.json", "mit_wall_follower/maps/*.*", "laser_logs/*.gz")
    return sorted(SAMPLES.iterdir()) + [path for pattern in patterns for path in sorted(folder.glob(pattern))]


def mutated(data: bytes, chance: np.random.Generator) -> bytes:
    """The data after one to four slips."""
    for _ in range(int(min(chance.geometric(0.6), 4))):
        if not data:
            break
        at = int(chance.integers(len(data)))
        length = int(min(chance.geometric(0.05), len(data) - at))
        match int(chance.integers(12)):
            case 0:
                data = data[:at] + bytes([int(chance.integers(256))]) + data[at + 1 :]
            case 1:
                data = data[:at] + data[at + length :]
            case 2:
                data = data[:at] + data[at : at + length] * int(chance.integers(2, 30)) + data[at + length :]
            case 3 if chance.random() < 0.3:
                data = data[:at]
            case _:
                data = _word_exchanged(data, at, chance)
    return data


def _word_exchanged(data: bytes, at: int, chance: np.random.Generator) -> bytes:
    """Another word instead of the first one from there on: an odd one, or one of the file."""
    match = WORD.search(data, at)
    if match is None:
        return data
    other = WORD.search(data, int(chance.integers(len(data))))
    odd = ODD_NUMBERS if match[0][:1] in b"-+0123456789" and chance.random() < 0.8 else ODD_WORDS
    word = odd[int(chance.integers(len(odd)))] if other is None or chance.random() < 0.6 else other[0]
    return data[: match.start()] + word + data[match.end() :]


def base_of(path: Path) -> bytes:
    """What is mutated: packed logs without their packing, every second time."""
    data = path.read_bytes()
    if path.suffix == ".gz" and len(data) > LARGEST // 10:
        data = gzip.decompress(data)
        return data[: LARGEST // 2]
    return data[:LARGEST]


def tried(path: Path) -> str:
    """What came of one file: "imported", "refused", or what went wrong."""
    try:
        if format_of(path) == LOG:
            for _ in entries(path):
                pass
        else:
            load(path, Options())
    except WorldFileError as error:
        return "refused" if "\n" not in str(error) and len(str(error)) < 500 else f"a message too long: {error}"
    except Exception as error:
        return f"{type(error).__name__}: {str(error)[:300]}"
    return "imported"


def main() -> int:
    """Try the files that are asked for and print what came of them."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--files", type=int, default=1000)
    arguments.add_argument("--seed", type=int, default=0)
    arguments.add_argument("--most", type=float, default=10.0, help="seconds for one file")
    given = arguments.parse_args()
    chance = np.random.default_rng(given.seed)
    paths = sources()
    counts: Counter[str] = Counter()
    by_file: Counter[str] = Counter()
    slowest, slowest_of, faults = 0.0, "", 0
    with tempfile.TemporaryDirectory() as folder:
        for path in paths:
            shutil.copy(path, Path(folder) / path.name)
        (Path(folder) / "bitmaps").symlink_to(folder)
        (Path(folder) / "maps").symlink_to(folder)
        for number in range(given.files):
            path = paths[number % len(paths)]
            place, before = Path(folder) / path.name, base_of(path)
            place.chmod(0o600)
            place.write_bytes(mutated(before, chance))
            begin = perf_counter()
            came = tried(place)
            seconds = perf_counter() - begin
            if seconds > slowest:
                slowest, slowest_of = seconds, path.name
            by_file[path.name] += came == "imported"
            counts[came if came in ("imported", "refused") else "faults"] += 1
            if came not in ("imported", "refused") or seconds > given.most:
                faults += 1
                kept = Path(tempfile.gettempdir()) / f"fuzzed-{number}-{path.name}"
                shutil.copy(place, kept)
                print(f"{kept}: {came} ({seconds:.1f} s)")
            place.write_bytes(path.read_bytes())
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"{given.files} files: {dict(counts)}; slowest {slowest:.2f} s ({slowest_of}); peak of memory {peak:.0f} MiB")
    never = [path.name for path in paths if not by_file[path.name]]
    print(f"never imported: {', '.join(never) or 'none'}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
