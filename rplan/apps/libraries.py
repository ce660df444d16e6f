"""Which libraries of behaviours there are: those that come with rplan, those that are installed, those in files.

Takes: the entry point group `rplan.libraries`, and Python files that the user names. Gives: `Catalogue`, library name →
library; `LibraryError` in one clear line where one cannot be loaded. Leaves alone: what libraries do.

An entry point, or a name at the top of a file, is a `behaviours.interface.Library` or a sequence of them.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping
from importlib.metadata import entry_points
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import MappingProxyType

from behaviours.catalogue import LIBRARIES
from behaviours.interface import Library

GROUP = "rplan.libraries"

Catalogue = Mapping[str, Library]


class LibraryError(Exception):
    """A library cannot be used; the message says which and why."""


def catalogue(files: Iterable[Path] = ()) -> Catalogue:
    """Every library that there is, with those of the files. Raises LibraryError."""
    found = dict(LIBRARIES)
    for where, library in (*_installed(), *(pair for file in files for pair in _in_file(file))):
        if library.name in found:
            raise LibraryError(f"{where}: there is a library `{library.name}` already")
        found[library.name] = library
    return MappingProxyType(found)


def _installed() -> Iterator[tuple[str, Library]]:
    for point in sorted(entry_points(group=GROUP), key=lambda point: point.name):
        where = f"the entry point {point.name} = {point.value}"
        try:
            offered = point.load()
        except Exception as error:
            raise LibraryError(f"{where} cannot be loaded: {type(error).__name__}: {error}") from error
        libraries = list(_libraries(offered))
        if not libraries:
            raise LibraryError(f"{where} is no behaviours.interface.Library")
        yield from ((where, library) for library in libraries)


def _in_file(path: Path) -> Iterator[tuple[str, Library]]:
    if not path.is_file():
        raise LibraryError(f"there is no file {path}")
    name = f"rplan_library_{path.stem}"
    spec = spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise LibraryError(f"{path} is not a Python file")
    module = module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        raise LibraryError(f"{path} cannot be loaded: {type(error).__name__}: {error}") from error
    seen: dict[str, Library] = {}
    for offered in vars(module).values():
        for library in _libraries(offered):
            if library not in LIBRARIES.values():
                seen.setdefault(library.name, library)
    if not seen:
        raise LibraryError(f"{path} has no behaviours.interface.Library at its top")
    yield from ((str(path), library) for library in seen.values())


def _libraries(offered: object) -> Iterator[Library]:
    match offered:
        case Library():
            yield offered
        case list() | tuple():
            yield from (one for one in offered if isinstance(one, Library))
