"""Rows on disk: the journal that grows as episodes end, and the table that is written in the end.

Takes: rows. Gives: a journal (JSON lines, beside the table) that survives whatever ends the sweep, and the table as
Parquet, by DuckDB, or as CSV. Leaves alone: what the columns say; work.py makes them.
"""

from __future__ import annotations

import csv
import json
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import IO, Literal

from rplan.apps.sweep.work import Row, Task, Value, Work, head

Type = Literal["VARCHAR", "BIGINT", "DOUBLE", "BOOLEAN"]
COLUMNS: Mapping[str, Type] = {
    "scenario": "VARCHAR",
    "seed": "BIGINT",
    "task": "VARCHAR",
    "done": "BOOLEAN",
    "reason": "VARCHAR",
    "stage": "VARCHAR",
    "departure": "DOUBLE",
    "arrival": "DOUBLE",
    "loaded": "DOUBLE",
    "home": "DOUBLE",
    "one_way": "DOUBLE",
    "round_trip": "DOUBLE",
    "duration": "DOUBLE",
    "distance": "DOUBLE",
    "contacts": "BIGINT",
    "driven_into": "BIGINT",
    "smallest_clearance": "DOUBLE",
    "ticks": "BIGINT",
    "holes": "BIGINT",
    "faults": "BIGINT",
    "wall": "DOUBLE",
    "real_time_factor": "DOUBLE",
    "error": "VARCHAR",
}
"""Those that every table has; swept parameters stand before the seed, more of a verdict at the end."""

MEASURED = ("wall", "real_time_factor")
"""Columns that differ from one machine to another; all others follow from the task."""


class JournalError(Exception):
    """A journal is not of this sweep; the message says why."""


# --- the journal --------------------------------------------------------------------------------------


def journal_of(table: Path) -> Path:
    """Where the rows of a table are kept until it is written."""
    return table.with_name(table.name + ".jsonl")


class Journal:
    """Rows as they come, one a line, each with the fingerprint of what it follows from."""

    def __init__(self, path: Path, work: Work) -> None:
        self.path = path
        self._marks = work.fingerprints()
        self._file: IO[str] | None = None

    def resumed(self, tasks: Iterable[Task]) -> dict[Task, Row]:
        """The rows that are there already. Raises JournalError for one that no task asks for.

        A last line without an end was being written when the sweep ended: it is cut off.
        """
        wanted = {(self._marks[task.variant], task.seed): task for task in tasks}
        whole, _, broken = self.path.read_bytes().rpartition(b"\n")
        found: dict[Task, Row] = {}
        for number, line in enumerate(whole.splitlines(), start=1):
            row = self._row(line, number)
            task = wanted.get((str(row.pop("sweep", "")), int(row.get("seed") or 0)))
            if task is None:
                raise JournalError(
                    f"{self.path}:{number}: an episode that this sweep does not ask for (another plan, scenario, "
                    "parameter, seed or --until); ask for it too, or move the file away"
                )
            found[task] = row
        if broken:
            with self.path.open("r+b") as file:
                file.truncate(len(whole) + 1 if whole else 0)
        return found

    def _row(self, line: bytes, number: int) -> Row:
        try:
            row = json.loads(line)
        except ValueError:
            row = None
        if not isinstance(row, dict) or not isinstance(row.get("seed"), int):
            raise JournalError(f"{self.path}:{number}: no row of a sweep")
        return row

    def add(self, task: Task, row: Row) -> None:
        """Write a row; it is with the system when this returns."""
        if self._file is None:
            self._file = self.path.open("a", encoding="utf-8")
        line = {"sweep": self._marks[task.variant], **row}
        self._file.write(json.dumps(line, ensure_ascii=False, allow_nan=False) + "\n")
        self._file.flush()

    def close(self) -> None:
        """Let go of the file."""
        if self._file is not None:
            self._file.close()
            self._file = None


# --- the table ----------------------------------------------------------------------------------------


def columns(work: Work, rows: Sequence[Row]) -> dict[str, Type]:
    """Every column with its type: parameters behind the scenario, what rows have beyond `COLUMNS` at the end."""
    parameters = [name for name in head(work.variants[0], 0) if name not in COLUMNS]
    more = [name for row in rows for name in row if name not in COLUMNS and name not in parameters]
    order = ["scenario", *parameters, *[name for name in COLUMNS if name != "scenario"], *dict.fromkeys(more)]
    return {name: COLUMNS.get(name) or _type([row.get(name) for row in rows]) for name in order}


def _type(values: Iterable[Value | None]) -> Type:
    """What all of them are; numbers where there is nothing to be seen."""
    kinds = {type(value) for value in values if value is not None}
    if kinds == {bool}:
        return "BOOLEAN"
    if kinds == {int}:
        return "BIGINT"
    return "DOUBLE" if kinds <= {int, float} else "VARCHAR"


def write(path: Path, work: Work, rows: Sequence[Row]) -> None:
    """The table in a file, whole or not at all: `.csv`, or else Parquet, which needs DuckDB. Raises OSError."""
    types = columns(work, rows)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.name}-") as folder:
        new = Path(folder) / "table"
        if path.suffix == ".csv":
            _write_csv(new, types, rows)
        else:
            _write_parquet(new, types, rows)
        new.replace(path)


def _write_csv(path: Path, types: Mapping[str, Type], rows: Iterable[Row]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(types)
        table.writerows([_cell(row.get(name)) for name in types] for row in rows)


def _cell(value: Value | None) -> str:
    match value:
        case None:
            return ""
        case bool():
            return "true" if value else "false"
        case _:
            return str(value)


def _write_parquet(path: Path, types: Mapping[str, Type], rows: Iterable[Row]) -> None:
    import duckdb

    lines = path.with_suffix(".jsonl")
    with lines.open("w", encoding="utf-8") as file:
        file.writelines(json.dumps({name: row.get(name) for name in types}) + "\n" for row in rows)
    with duckdb.connect() as database:
        table = database.read_json(str(lines), columns=dict(types), format="newline_delimited")
        table.write_parquet(str(path), compression="zstd")
