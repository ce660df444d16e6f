"""What is built and released: version, wheel, gate, and no trace of the machine that it was written on."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
import zipfile
from pathlib import Path

from hatchling.builders.wheel import WheelBuilder

MACHINE = re.compile(r"(?<![\w.~-])/(?:work|tmp|root|home|opt|Users)/")
ANYWHERE = ("tests/repo/test_packaging.py",)
"""Speaks of such places on purpose."""
UNFINISHED = re.compile(r"TODO|FIXME|XXX|NotImplementedError|pragma: no cover|type: ignore|pytest\.skip|xfail")


def test_the_version_is_the_newest_of_the_changelog(root: Path) -> None:
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    newest = re.search(r"^## \[([\d.]+)\]", (root / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert newest is not None
    assert newest[1] == project["version"]


def test_no_text_has_a_path_of_somebodys_machine(texts: dict[Path, str], root: Path) -> None:
    found = [
        f"{path.relative_to(root)}:{number}"
        for path, text in texts.items()
        if str(path.relative_to(root)) not in ANYWHERE
        for number, line in enumerate(text.splitlines(), start=1)
        if MACHINE.search(line)
    ]
    assert found == []


WITHOUT_DATA = 'pytest.skip(f"there is no data folder'
"""What only tests of worlds and logs say that do not come with the project."""


def test_nothing_is_left_for_later(texts: dict[Path, str], root: Path) -> None:
    found = [
        f"{path.relative_to(root)}: {word}"
        for path, text in texts.items()
        if path.suffix == ".py" and path != Path(__file__)
        for word in UNFINISHED.findall(text.replace(WITHOUT_DATA, ""))
    ]
    assert found == []


OF_OTHER_NAMES = {"PIL": "pillow", "_pytest": "pytest", "foxglove": "foxglove-sdk", "yaml": "pyyaml", "z3": "z3-solver"}
"""Modules that are not called as what is installed for them."""


def test_everything_that_is_imported_is_asked_for(texts: dict[Path, str], root: Path) -> None:
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    wanted = [*project["dependencies"], *(one for extra in project["optional-dependencies"].values() for one in extra)]
    known = {re.split(r"[^\w-]", one)[0].lower() for one in wanted}
    known |= {*sys.stdlib_module_names, "_typeshed", "behaviours", "sim"}
    known |= {path.stem for folder in ("tests", "docs") for path in (root / folder).rglob("*")} | {"tests", "docs"}
    found = [
        f"{path.relative_to(root)}: {module}"
        for path, text in texts.items()
        if path.suffix == ".py"
        for module in modules(text)
        if OF_OTHER_NAMES.get(module, module) not in known
    ]
    assert found == []


def modules(text: str) -> list[str]:
    """What a program imports, without the parts of packages."""
    nodes = list(ast.walk(ast.parse(text)))
    names = [one.name for node in nodes if isinstance(node, ast.Import) for one in node.names]
    names += [node.module or "" for node in nodes if isinstance(node, ast.ImportFrom) and node.level == 0]
    return [name.partition(".")[0] for name in names]


def test_the_gate_runs_the_test_command_of_the_readme(root: Path) -> None:
    command = "python tests/run.py"
    assert f".venv/bin/{command}\n" in (root / "README.md").read_text(encoding="utf-8")
    gate = (root / ".ci" / "run").read_text(encoding="utf-8")
    assert "set -euo pipefail" in gate
    assert gate.rstrip().endswith('/python" tests/run.py')


def test_the_wheel_has_the_packages_and_the_plans_and_nothing_else(root: Path, tmp_path: Path) -> None:
    wheel = next(iter(WheelBuilder(str(root)).build(directory=str(tmp_path), versions=["standard"])))
    names = [name for name in zipfile.ZipFile(wheel).namelist() if ".dist-info/" not in name]
    packages = [name for folder in ("rplan", "behaviours", "sim") for name in contents(root, folder, IN_PACKAGES)]
    plans = [f"rplan/_{name}" for name in contents(root, "plans", IN_PLANS)]
    assert sorted(names) == sorted(packages + plans)
    for one in (
        "rplan/_plans/find_and_fetch/parking_lot.yaml",
        "sim/replay.html",
        "sim/circuit.js",
        "rplan/apps/viewer/live.js",
    ):
        assert one in names


IN_PACKAGES = {".py", ".typed", ".html", ".js", ".c", ".lark", ".txt", ".json"}
IN_PLANS = {".rplan", ".yaml", ".ticks", ".txt"}
"""Tests of plans and what wrote their worlds stay in the checkout."""


def contents(root: Path, folder: str, suffixes: set[str]) -> list[str]:
    found = sorted(path for path in (root / folder).rglob("*") if path.suffix in suffixes)
    return [str(path.relative_to(root)) for path in found]
