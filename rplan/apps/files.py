"""Files that commands are given: which plan, which scenario, and what to say when they cannot be read.

Takes: paths as the user wrote them. Gives: files that exist, or an `InputError` (exit code 2) with a clear line.
Leaves alone: what stands in them.
"""

from __future__ import annotations

from pathlib import Path
from typing import NoReturn

import click

PACKAGED = Path(__file__).parent.parent / "_plans"
"""Plans that come with an installed rplan; in a checkout they are in `plans/`."""


class InputError(click.ClickException):
    """What was given cannot be used."""

    exit_code = 2

    def show(self, file: object = None) -> None:  # noqa: ARG002
        click.echo(f"error: {self.format_message()}", err=True)


SHARED = "lib"
"""The folder of rules that several plans include; no plan of its own."""


def plans_folder() -> Path:
    """Where the plans are that come with rplan."""
    return PACKAGED if PACKAGED.is_dir() else Path(__file__).parent.parent.parent / "plans"


def packaged_plans() -> list[Path]:
    """Every plan file that comes with rplan."""
    return sorted(path for path in plans_folder().glob("*/*.rplan") if path.parent.name != SHARED)


def plan_file(given: str) -> Path:
    """The plan file that a user means: a file, a folder with one plan, or the name of a plan that comes with rplan."""
    path = Path(given)
    if not path.exists():
        coming = plans_folder() / (path.name if path.parent.name in ("", "plans") else given)
        if not coming.exists():
            names = ", ".join(dict.fromkeys(plan.parent.name for plan in packaged_plans()))
            raise InputError(f"there is no file or folder {given} (plans that come with rplan: {names})")
        path = coming
    if path.is_dir():
        return _plan_in(path)
    return path


def _plan_in(folder: Path) -> Path:
    named = folder / f"{folder.resolve().name}.rplan"
    if named.is_file():
        return named
    found = sorted(folder.glob("*.rplan"))
    if len(found) == 1:
        return found[0]
    if not found:
        raise InputError(f"the folder {folder} has no plan (*.rplan)")
    raise InputError(f"the folder {folder} has several plans; say which: {', '.join(str(plan) for plan in found)}")


def scenario_file(given: str | None, plan: Path) -> Path:
    """The scenario that a user means; without one the only one beside the plan."""
    if given is not None:
        path = Path(given)
        if path.is_file() or Path(given.rpartition("#")[0]).is_file():
            return path
        if path.is_dir():
            raise InputError(f"{given} is a folder; a scenario is a YAML file")
        name = given if given.endswith((".yaml", ".yml")) else f"{given}.yaml"
        for folder in (plan.parent, plan.parent.parent, plans_folder()):
            if (folder / name).is_file():
                return folder / name
        raise InputError(f"there is no scenario {given} (scenarios that come with rplan: {_coming_scenarios()})")
    found = sorted(plan.parent.glob("*.yaml"))
    if len(found) == 1:
        return found[0]
    if not found:
        such = ", ".join(f"worlds/{one.stem}" for one in sorted(plan.parent.glob("worlds/*.yaml")))
        such = such or _coming_scenarios()
        raise InputError(f"there is no scenario (*.yaml) beside {plan}; give one with --scenario, such as {such}")
    raise InputError(f"there are several scenarios; say which with --scenario: {', '.join(s.name for s in found)}")


def _coming_scenarios() -> str:
    found = sorted(plans_folder().glob("*/*.yaml"))
    return ", ".join(f"{path.parent.name}/{path.stem}" for path in found)


def unreadable(path: Path, error: OSError) -> NoReturn:
    """Raise the `InputError` for a file that the system does not give."""
    raise InputError(f"{path}: {error.strerror or error}") from error
