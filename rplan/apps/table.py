"""A run as a table: one row a tick, flat columns, as CSV or Parquet.

Takes: a `Recording` and where to write. Gives: the file; columns are the same for every run of a plan.
Leaves alone: full readings (`sim.recording.readings` has them).

Columns: `tick`, `t` [s], `stage`, the true pose `x`, `y` [m], `heading` [rad], the believed one (`odometry_…`), the
command (`speed` [m/s], `turn_rate` [rad/s], `look_pan`, `look_tilt`, `flippers`), the head (`pan`, `tilt` [rad]),
`on_board`, `contacts`; for each condition of the plan a column of its canonical text; for each output what the way set
(`output NAME`) and what was sent (`sent NAME`); `hole`, `way` (rules that were served), `given_up`, `faults`.
Parquet is written by duckdb, which comes with the extra `rplan[data]`.
"""

from __future__ import annotations

import csv
import json
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from sim.plain import listed, mapping
from sim.recording import Json, Recording

Row = dict[str, object]

BEFORE = {
    "tick": "BIGINT",
    "t": "DOUBLE",
    "stage": "VARCHAR",
    **dict.fromkeys(("x", "y", "heading", "odometry_x", "odometry_y", "odometry_heading"), "DOUBLE"),
    **dict.fromkeys(("speed", "turn_rate", "look_pan", "look_tilt"), "DOUBLE"),
    "flippers": "BOOLEAN",
    **dict.fromkeys(("pan", "tilt"), "DOUBLE"),
    "on_board": "BOOLEAN",
    "contacts": "VARCHAR",
}
AFTER = {"hole": "BOOLEAN", "way": "VARCHAR", "given_up": "VARCHAR", "faults": "VARCHAR"}


def columns(header: Json) -> dict[str, str]:
    """Name -> SQL type, in order."""
    plan = mapping(header.get("plan"))
    named = dict(BEFORE)
    named |= {str(text): "BOOLEAN" for text in listed(plan.get("inputs"))}
    outputs = [str(name) for name in listed(plan.get("outputs"))]
    named |= {f"{kind} {name}": "VARCHAR" for kind in ("output", "sent") for name in outputs}
    return named | AFTER


def rows(recording: Recording) -> Iterator[Row]:
    """Column -> value for each tick; what a tick does not say is None."""
    inputs = [str(text) for text in listed(mapping(recording.header.get("plan")).get("inputs"))]
    for tick in recording.ticks:
        yield (
            {"tick": tick.get("tick"), "t": tick.get("t")}
            | _world(mapping(tick.get("world")))
            | _plan(mapping(tick.get("plan")), inputs)
        )


def write_csv(recording: Recording, path: Path | str) -> int:
    """Write the table as CSV in UTF-8 and give the number of its rows. Raises OSError, RecordingError."""
    names, count = columns(recording.header), 0
    with Path(path).open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(names)
        for row in rows(recording):
            table.writerow([_text(row.get(name)) for name in names])
            count += 1
    return count


def write_parquet(recording: Recording, path: Path | str) -> int:
    """Write the table as Parquet and give the number of its rows.

    Raises ImportError without duckdb, OSError, RecordingError.
    """
    try:
        import duckdb
    except ImportError as fault:
        raise ImportError("Parquet needs DuckDB: pip install 'rplan[data]', or write a .csv", name="duckdb") from fault
    path = Path(path)
    path.open("wb").close()  # a place that cannot be written is an OSError
    with tempfile.TemporaryDirectory() as folder, duckdb.connect() as database:
        table = Path(folder) / "run.csv"
        count = write_csv(recording, table)
        types = columns(recording.header)
        database.read_csv(str(table), header=True, dtype=types, delimiter=",", quotechar='"').write_parquet(str(path))
    return count


# --- a tick ---------------------------------------------------------------------------------------


def _world(world: Json) -> Row:
    command = mapping(world.get("command"))
    row: Row = {"stage": world.get("stage"), "on_board": world.get("on_board"), "flippers": command.get("flippers")}
    row |= _spread(world.get("robot"), ("x", "y", "heading"))
    row |= _spread(world.get("odometry"), ("odometry_x", "odometry_y", "odometry_heading"))
    row |= _spread(command.get("drive"), ("speed", "turn_rate"))
    row |= _spread(command.get("head"), ("look_pan", "look_tilt"))
    row |= _spread(world.get("head"), ("pan", "tilt"))
    row["contacts"] = _joined(mapping(contact).get("thing") for contact in listed(world.get("contacts")))
    return row


def _plan(plan: Json, inputs: Sequence[str]) -> Row:
    way = mapping(plan.get("way"))
    row: Row = {text: bit == "1" for text, bit in zip(inputs, str(plan.get("inputs", "")), strict=False)}
    row |= {f"output {name}": value for name, value in mapping(plan.get("outputs")).items()}
    row |= {f"sent {name}": value for name, value in mapping(plan.get("sent")).items()}
    row |= {"hole": plan.get("hole"), "way": _joined(listed(way.get("rules")))}
    row["given_up"] = _joined(mapping(lost).get("member") for lost in listed(way.get("given_up")))
    row["faults"] = _joined(
        f"{mapping(fault).get('competence')}: {mapping(fault).get('message')}" for fault in listed(plan.get("faults"))
    )
    return row


def _spread(value: object, names: Sequence[str]) -> Row:
    return dict(zip(names, listed(value), strict=False))


def _joined(parts: Iterable[object]) -> str | None:
    return "; ".join(map(str, parts)) or None


def _text(value: object) -> object:
    """As it stands in the file; nothing for None."""
    match value:
        case None:
            return ""
        case bool():
            return "true" if value else "false"
        case str() | int() | float():
            return value
        case _:
            return json.dumps(value, ensure_ascii=False, separators=(",", ":"))
