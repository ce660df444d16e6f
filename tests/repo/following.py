"""Pages followed as a reader would: files written, commands typed, one after the other in one place.

Takes: Markdown. Gives: the same text with what the commands print now. Leaves alone: what a page should say, and text
that is no block.

A block with `title="FILE"` is the whole of that file; with `title="FILE, as it stands"` it shows what is there. A
block of text without a title is a session of lines `$ COMMAND` and what they print. Every block is one or the other.
"""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from click.testing import CliRunner

from rplan.apps.cli import cli

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(
    r"^```(?P<kind>\w*)(?: title=\"(?P<title>[^\"]+)\")?(?P<rest>[^\n]*)\n(?P<body>.*?)^```$", re.M | re.S
)
STANDS = ", as it stands"
MEASURED = (
    (re.compile(r"\(\d+\.\d\d s\)"), lambda _: "(0.01 s)"),
    (re.compile(r" in \d+\.\d\ds"), lambda _: " in 0.50s"),
    (re.compile(r"(?<=real-time factor)( +\d+)"), lambda found: f"{300:>{len(found[1])}}"),
)
"""What no page can promise: how long a proof, pytest and a simulation took."""


class PageError(Exception):
    """A block of a page that cannot be followed."""


@dataclass(frozen=True, slots=True)
class Reader:
    """Somebody at a shell. missing: texts for blocks of files that are empty."""

    missing: dict[str, str]

    def follow(self, page: str) -> str:
        """Do what the page says; the page as it should be."""
        return BLOCK.sub(self._block, page)

    def _block(self, block: re.Match[str]) -> str:
        kind, title, body = block["kind"], block["title"], block["body"]
        if title is None and kind == "text" and body.startswith("$ "):
            new = session(body)
        elif title is None:
            raise PageError(f"a block that nobody runs: {block[0]}")
        elif title.endswith(STANDS):
            new = Path(title.removesuffix(STANDS)).read_text(encoding="utf-8")
        else:
            new = body or self.missing[title]
            Path(title).write_text(new, encoding="utf-8")
        return f"{block[0].partition(chr(10))[0]}\n{new}```"


def session(text: str) -> str:
    """A session with every command run again."""
    commands = re.findall(r"^\$ (.*)$", text, re.MULTILINE)
    return "".join(f"$ {command}\n{_clean(run(command))}" for command in commands)


def run(command: str) -> str:
    """What a line prints, on both streams."""
    given, _, called = command.rpartition(" | ")
    program, *arguments = shlex.split(called)
    match program:
        case "cd":
            os.chdir(arguments[0])
            return ""
        case "rplan":
            text = shlex.split(given)[1] + "\n" if given else None
            return CliRunner().invoke(cli, arguments, input=text, env={"COLUMNS": "100"}).output
        case "pytest":
            return _run([sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *arguments])
        case "sed":
            return _run([program, *arguments])
    raise PageError(f"{command}: the reader has no {program}")


def _run(command: list[str]) -> str:
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("PYTEST", "COV"))}
    environment = kept | {"PYTHONPATH": str(ROOT), "NO_COLOR": "1", "COLUMNS": "80", "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    return done.stdout + done.stderr


def _clean(printed: str) -> str:
    for pattern, steady in MEASURED:
        printed = pattern.sub(steady, printed)
    lines = [line.rstrip() for line in printed.strip("\n").splitlines()]
    return "".join(f"{line}\n" for line in lines)
