"""Worlds and logs of other formats: one importer a file; `choose.py` finds the one that a file needs."""

from sim.scenarios.importers.choose import FORMATS, LOG, format_of, load, read, split, summary, text_of
from sim.scenarios.importers.imported import Imported, Options, WorldFileError

__all__ = [
    "FORMATS",
    "LOG",
    "Imported",
    "Options",
    "WorldFileError",
    "format_of",
    "load",
    "read",
    "split",
    "summary",
    "text_of",
]
