"""The command line: `rplan COMMAND …`.

Takes: arguments. Gives: exit codes of L24 and clear lines, never a traceback. Leaves alone: what commands do; each is
a file of commands/, imported only when it is called, so that `rplan --help` answers at once.
"""

from __future__ import annotations

import sys
from importlib import import_module
from io import TextIOWrapper
from keyword import iskeyword
from traceback import walk_tb

import click

COMMANDS = {
    "check": "Say what is wrong with a plan before it runs.",
    "compile": "Compile a plan and say what a tick costs.",
    "diff": "Say in which situations two plans differ.",
    "export": "Make a table or a film of a recording.",
    "fmt": "Lay out the text of plans, comments and all.",
    "import": "Make a scenario of a world of another format.",
    "inspect": "Show how a plan decides: table, goals, circuit, percepts.",
    "list": "List plans, libraries and what they offer.",
    "map": "Make a map file or a picture of the map in a recording.",
    "mutate": "Say whether the tests of a plan notice a slip in it.",
    "new": "Make a fresh project with a plan of its own.",
    "prove": "Prove what a plan promises, or show how it breaks it.",
    "repair": "Make a whole file of a recording that was cut short.",
    "replay": "Make a page that plays a recording.",
    "reproduce": "Run the experiments of a paper again, its figures beside ours.",
    "simulate": "Drive a robot through a world by a plan.",
    "sweep": "Run many episodes of a plan and keep a row of each.",
    "test": "Run the tests that stand in a plan.",
    "tick": "Run a plan alone: percepts in, outputs out, one JSON object a line.",
    "view": "Watch a plan while its simulation runs.",
    "ways": "List the ways of a plan; --paper counts them as the paper does.",
    "why": "Say why a tick did what it did, and what lost.",
    "why-not": "Say what would have made a tick do otherwise.",
}
USED_WRONGLY = 2
INTERNAL = 70
OF_A_LIBRARY = "rplan_library_"
"""Begins the names of modules that `--library FILE` loads."""
INSTALLED = "rplan.libraries"
"""The entry points of libraries that are installed; libraries.py has the same, and is not loaded for a fault."""
OWN = ("rplan", "behaviours", "sim")


class Commands(click.Group):
    """Commands by name, loaded late."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:  # noqa: ARG002
        if name not in COMMANDS:
            return None
        command = import_module(f"rplan.apps.commands.{name.replace('-', '_')}{'_' if iskeyword(name) else ''}").command
        assert isinstance(command, click.Command)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args and args[0] not in COMMANDS and not args[0].startswith("-"):
            from difflib import get_close_matches

            meant = get_close_matches(args[0], list(COMMANDS), 1)
            hint = f" Did you mean '{meant[0]}'?" if meant else ""
            ctx.fail(f"There is no command '{args[0]}'.{hint} There are: {', '.join(COMMANDS)}.")
        return super().resolve_command(ctx, args)


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="rplan", prog_name="rplan")
def cli() -> None:
    """Plans for robots: goals, priorities and reduction rules, checked before they run and explained afterwards."""


def main() -> None:
    """The entry point.

    A fault of rplan's own says so and exits with 70; one of a library of the user's, and what the system refuses (a
    full disk), with 2. Ctrl-C and a reader that goes away are click's affair: it ends quietly. A letter that the
    terminal does not have is a question mark.
    """
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")
    try:
        cli()
    except OSError as error:
        what = "" if error.filename is None else f"{error.filename}: "
        click.echo(f"error: {what}{error.strerror or error}", err=True)
        sys.exit(USED_WRONGLY)
    except Exception as error:
        _report(error)


def _report(error: Exception) -> None:
    places = [(str(frame.f_globals.get("__name__")), frame, line) for frame, line in walk_tb(error.__traceback__)]
    installed = _installed_packages()
    for name, frame, line in reversed(places):
        if name.startswith(OF_A_LIBRARY) or name.partition(".")[0] in installed:
            place = f"{frame.f_code.co_filename}:{line}"
            click.echo(f"error: {place}: the library fails: {type(error).__name__}: {error}", err=True)
            sys.exit(USED_WRONGLY)
    where = f" ({places[-1][0]}:{places[-1][2]})" if places else ""
    click.echo(f"rplan has a fault of its own: {type(error).__name__}: {error}{where}", err=True)
    click.echo("Nothing is wrong with your plan as far as is known; please report this with the plan.", err=True)
    sys.exit(INTERNAL)


def _installed_packages() -> frozenset[str]:
    """The packages that installed libraries are in."""
    from importlib.metadata import entry_points

    return frozenset(point.module.partition(".")[0] for point in entry_points(group=INSTALLED)).difference(OWN)
