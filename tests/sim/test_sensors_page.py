"""The page on sensors tells the fields, defaults and rates that the code has."""

from __future__ import annotations

import math
import re
from dataclasses import fields
from pathlib import Path

import pytest

from behaviours.interface import Pose
from sim.robots.build import Build
from sim.sensors.build import (
    FAULTS,
    BumperBuild,
    CompassBuild,
    CurrentBuild,
    GpsBuild,
    ImuBuild,
    InclinometerBuild,
    InfraredBuild,
    Installed,
    LidarBuild,
    OdometryBuild,
    SensorBuild,
    SonarBuild,
    StereoBuild,
)
from sim.sensors.suite import instrument

PAGE = (Path(__file__).parents[2] / "docs" / "reference" / "sensors.md").read_text(encoding="utf-8")
BUILDS: dict[str, SensorBuild] = {
    "sonar": SonarBuild(),
    "lidar": LidarBuild(),
    "infrared": InfraredBuild(),
    "stereo": StereoBuild(),
    "odometry": OdometryBuild(),
    "compass": CompassBuild(),
    "imu": ImuBuild(),
    "inclinometer": InclinometerBuild(),
    "gps": GpsBuild(),
    "currents": CurrentBuild(),
    "bumper": BumperBuild(),
}


def rows(heading: str) -> list[list[str]]:
    """The cells of all tables of a section."""
    section = re.split(r"^## ", PAGE, flags=re.MULTILINE)
    (text,) = [part for part in section if part.startswith(heading + "\n")]
    lines = [line for line in text.splitlines() if line.startswith("| ") and not line.startswith("| ---")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def number(text: str) -> float:
    return math.radians(float(text.removesuffix("deg"))) if text.endswith("deg") else float(text)


@pytest.mark.parametrize("kind", BUILDS)
def test_the_section_of_a_kind_has_all_its_fields_and_their_defaults(kind):
    told = {cells[0].strip("`"): number(cells[2]) for cells in rows(kind)[1:]}
    assert list(told) == [field.name for field in fields(BUILDS[kind])]
    for name, default in told.items():
        assert default == pytest.approx(getattr(BUILDS[kind], name))


def test_the_table_of_kinds_tells_which_fields_they_fill():
    table = [cells for cells in rows("What all have") if cells[0].strip("`") in BUILDS]
    assert [cells[0].strip("`") for cells in table] == list(BUILDS)
    for cells in table:
        made = instrument(Installed("a", BUILDS[cells[0].strip("`")]), Build(), Pose(0, 0), 0)
        assert tuple(re.findall(r"`(\w+)`", cells[1])) == made.fields


def test_all_faults_are_told_and_what_they_do_to_each_kind():
    table = rows("Faults")
    assert [cells[0].strip("`") for cells in table[1:5]] == list(FAULTS)
    assert sorted(kind for cells in table[6:] for kind in re.findall(r"`(\w+)`", cells[0])) == sorted(BUILDS)
