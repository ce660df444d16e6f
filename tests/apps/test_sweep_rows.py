"""Rows on disk: a journal that survives, and tables with a type for every column."""

from __future__ import annotations

import csv
import dataclasses
import json
from pathlib import Path

import duckdb
import pytest

from rplan.apps.sweep.rows import COLUMNS, Journal, JournalError, columns, journal_of, write
from rplan.apps.sweep.work import Row, Task, Variant, Work, tasks
from rplan.lang.source import Source

WORK = Work(
    (Source("p.rplan", "(plan p)"),),
    (
        Variant("lot", "lot.yaml", "name: lot", (), (("runaway.release", 0.1), ("scenario.robot.start", "[0,0]"))),
        Variant("lot", "lot.yaml", "name: lot2", (), (("runaway.release", 0.2), ("scenario.robot.start", "[0,1]"))),
    ),
)
ROWS: list[Row] = [
    {"scenario": "lot", "runaway.release": 0.1, "scenario.robot.start": "[0,0]", "seed": 3, "done": True, "ticks": 7},
    {
        "scenario": "lot",
        "runaway.release": 0.2,
        "scenario.robot.start": "[0,1]",
        "seed": 4,
        "done": False,
        "reason": 'he said "no", and\nleft – früh',
        "smallest_clearance": 0.1 + 0.2,
        "laps": 2,
        "parked": None,
    },
]


def resumed(path: Path, work: Work = WORK) -> list[Row]:
    return list(Journal(path, work).resumed(tasks(work, (3, 4))).values())


def filled(path: Path) -> None:
    journal = Journal(path, WORK)
    journal.add(Task(0, 0, 3), ROWS[0])
    journal.add(Task(3, 1, 4), ROWS[1])
    journal.close()


# --- the journal --------------------------------------------------------------------------------------


def test_rows_of_a_journal_are_read_as_they_were_written(tmp_path: Path) -> None:
    path = journal_of(tmp_path / "rows.parquet")
    assert path.name == "rows.parquet.jsonl"
    filled(path)
    assert Journal(path, WORK).resumed(tasks(WORK, (3, 4))) == {Task(0, 0, 3): ROWS[0], Task(3, 1, 4): ROWS[1]}


@pytest.mark.parametrize("cut", [1, 2, 50, 100])
def test_a_line_that_was_being_written_is_cut_off(tmp_path: Path, cut: int) -> None:
    path = tmp_path / "j.jsonl"
    filled(path)
    path.write_bytes(path.read_bytes()[:-cut])
    assert resumed(path) == ROWS[:1]
    journal = Journal(path, WORK)
    journal.add(Task(3, 1, 4), ROWS[1])
    journal.close()
    assert resumed(path) == ROWS


def test_a_journal_of_half_a_line_has_no_rows_and_is_begun_anew(tmp_path: Path) -> None:
    path = tmp_path / "j.jsonl"
    path.write_text('{"sweep": "12')
    assert resumed(path) == []
    filled(path)
    assert resumed(path) == ROWS


def test_every_row_is_on_disk_as_soon_as_it_is_added(tmp_path: Path) -> None:
    journal = Journal(tmp_path / "j.jsonl", WORK)
    journal.add(Task(0, 0, 3), ROWS[0])
    assert resumed(tmp_path / "j.jsonl") == ROWS[:1]
    journal.close()


@pytest.mark.parametrize(
    "other",
    [
        dataclasses.replace(WORK, until=3.0),
        dataclasses.replace(WORK, allow_holes=True),
        dataclasses.replace(WORK, sources=(Source("p.rplan", "(plan q)"),)),
        dataclasses.replace(WORK, variants=WORK.variants[:1]),
    ],
)
def test_rows_of_another_sweep_are_refused(tmp_path: Path, other: Work) -> None:
    filled(tmp_path / "j.jsonl")
    with pytest.raises(JournalError, match=r"j\.jsonl:\d: an episode that this sweep does not ask for"):
        resumed(tmp_path / "j.jsonl", other)


def test_rows_of_another_library_file_are_refused(tmp_path: Path) -> None:
    library = tmp_path / "spin.py"
    library.write_text("A = 1")
    work = dataclasses.replace(WORK, library_files=(library,))
    before = work.fingerprints()
    library.write_text("A = 2")
    assert work.fingerprints() != before


@pytest.mark.parametrize("line", ["nonsense", "[]", "{}", '{"seed": "3"}', "\ufffd"])
def test_a_line_that_is_no_row_is_told_with_its_number(tmp_path: Path, line: str) -> None:
    filled(tmp_path / "j.jsonl")
    with (tmp_path / "j.jsonl").open("a", encoding="utf-8") as file:
        file.write(line + "\n")
    with pytest.raises(JournalError, match=r"j\.jsonl:3: no row of a sweep"):
        resumed(tmp_path / "j.jsonl")


# --- the table ----------------------------------------------------------------------------------------


def test_parameters_stand_before_the_seed_and_more_of_a_verdict_at_the_end() -> None:
    names = list(columns(WORK, ROWS))
    assert names[:4] == ["scenario", "runaway.release", "scenario.robot.start", "seed"]
    assert names[-3:] == ["error", "laps", "parked"]
    assert [name for name in names if name in COLUMNS] == list(COLUMNS)


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ((True, None), "BOOLEAN"),
        ((1, 2), "BIGINT"),
        ((1, 2.5), "DOUBLE"),
        ((None, None), "DOUBLE"),
        ((1, "a"), "VARCHAR"),
        ((True, 1), "VARCHAR"),
    ],
)
def test_a_column_has_the_type_of_all_its_values(values: tuple[int | None, ...], expected: str) -> None:
    assert columns(WORK, [{"more": value} for value in values])["more"] == expected


def test_parquet_has_every_row_value_and_type(tmp_path: Path) -> None:
    path = tmp_path / "it's rows.parquet"
    write(path, WORK, ROWS)
    with duckdb.connect() as database:
        table = database.read_parquet(str(path))
        types = dict(zip(table.columns, map(str, table.types), strict=True))
        rows = [dict(zip(table.columns, row, strict=True)) for row in table.fetchall()]
    assert types == columns(WORK, ROWS)
    assert rows == [{name: row.get(name) for name in types} for row in ROWS]
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


def test_csv_has_every_row_and_value(tmp_path: Path) -> None:
    path = tmp_path / "rows.csv"
    write(path, WORK, ROWS)
    with path.open(newline="", encoding="utf-8") as file:
        first, second = csv.DictReader(file)
    assert (first["done"], first["ticks"], first["reason"], first["runaway.release"]) == ("true", "7", "", "0.1")
    assert (second["done"], second["reason"]) == ("false", ROWS[1]["reason"])
    assert float(second["smallest_clearance"]) == 0.1 + 0.2
    assert list(first) == list(columns(WORK, ROWS))


def test_a_table_is_replaced_whole_or_not_at_all(tmp_path: Path) -> None:
    path = tmp_path / "rows.csv"
    path.write_text("before")
    bad: Row = json.loads('{"reason": "\\ud800"}')
    with pytest.raises(UnicodeEncodeError):
        write(path, WORK, [bad])
    assert path.read_text() == "before"
    assert [file.name for file in tmp_path.iterdir()] == ["rows.csv"]
