"""Pages followed as a reader would: files written, commands typed, one after the other in one place.

Takes: Markdown. Gives: the same text with what the commands print now. Leaves alone: what a page should say, and text
that is no block. What a block is for is told by its first line:

- `title="FILE"`: the whole of that file. `title="FILE, as it stands"`: what is there now.
- `text` that begins with `$ COMMAND`: a session. A simulation whose output the page leaves out stays without.
- `sh`: commands that work. `python`: a program, and a `text` right after it what it prints; `python part` only is
  Python. `lisp`: a plan that compiles, `lisp wrong` one that does not. `toml`, `sql`: such a text.
- `<!-- $ COMMAND -->`: done, and not shown. `text` right after it shows some of the lines that it prints.
"""

from __future__ import annotations

import io
import os
import re
import shlex
import subprocess
import sys
import tomllib
from contextlib import redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path
from shutil import which
from textwrap import dedent

from click.testing import CliRunner

from rplan.apps.cli import cli
from rplan.apps.wiring import signatures
from rplan.driver import compile_plan
from rplan.lang.diagnostic import PlanError
from rplan.lang.source import Source

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(
    r"^<!-- \$ (?P<silent>[^\n]*) -->$|"
    r"^(?P<indent> *)```(?P<kind>\w*(?: wrong| part)?)(?: title=\"(?P<title>[^\"]+)\")?(?: hl_lines=\"[\d ]+\")?\n"
    r"(?P<body>.*?)^(?P=indent)```$",
    re.MULTILINE | re.DOTALL,
)
STANDS = ", as it stands"
SOME = "--seeds 0..1 --until 3 --workers 1"
QUICK = {"--seeds 0..99": SOME, "--seeds 0..19": SOME, "reproduce B": "reproduce --seeds 1 B"}
"""What is long is done shorter: fewer seeds, less time."""
FILM = () if which("ffmpeg") else ("--video",)
ELSEWHERE = (
    "dask ",
    "--scheduler tcp://HOST",
    "pip install",
    "rplan view",
    "reproduce find-and-fetch",
    "reproduce wayfarer",
    "reproduce wall-following",
    "reproduce B4 --preset both",
    *FILM,
)
"""What needs other machines, the network, somebody who looks, an hour, or a program that not everybody has."""
MEASURED = (
    (re.compile(r"\(\d+\.\d\d s\)"), lambda _: "(0.01 s)"),
    (re.compile(r" in \d+\.\d\ds"), lambda _: " in 0.50s"),
    (re.compile(r"(?<=real-time factor)( +\d+)"), lambda found: f"{300:>{len(found[1])}}"),
)
"""What no page can promise: how long a proof, pytest and a simulation took."""


PLUGINS = ("-p", "no:cacheprovider", "-p", "rplan.apps.pytest_plugin")
"""Of a reader who has installed no others."""
PLAIN: dict[str, str | None] = {"NO_COLOR": "1"} | dict.fromkeys(
    ("CI", "BUILD_NUMBER", "FORCE_COLOR", "CLICOLOR_FORCE", "PY_COLORS", "TTY_COMPATIBLE")
)
"""What programs print to a reader at a plain terminal: no colours, and summaries cut to its width."""


class PageError(Exception):
    """A block of a page that cannot be followed, or that does not do what the page says."""


@dataclass(slots=True)
class Reader:
    """Somebody at a shell.

    missing: texts for blocks of files that are empty. said: what the last program or hidden command printed, where the
    page has not gone on since; some: it may be shown in part.
    """

    missing: dict[str, str] = field(default_factory=dict)
    said: str | None = None
    some: bool = False

    def follow(self, page: str) -> str:
        """Do what the page says; the page as it should be."""
        return BLOCK.sub(self._block, page)

    def _block(self, block: re.Match[str]) -> str:
        said, some = self.said, self.some
        self.said, self.some = None, False
        if block["silent"] is not None:
            self.said, self.some = _clean(run(block["silent"])), True
            return block[0]
        if block["title"] is not None:
            new = self._file(block["title"], block["body"])
        elif block["kind"] == "text":
            new = _text(block["body"], said, some)
        else:
            self._program(block["kind"], dedent(block["body"]))
            return block[0]
        return f"{block[0].partition(chr(10))[0]}\n{new}```"

    def _file(self, title: str, body: str) -> str:
        if title.endswith(STANDS):
            return Path(title.removesuffix(STANDS)).read_text(encoding="utf-8")
        new = body or self.missing[title]
        Path(title).write_text(new, encoding="utf-8")
        return new

    def _program(self, kind: str, body: str) -> None:
        match kind:
            case "sh":
                for line in body.replace("\\\n", " ").splitlines():
                    works(line)
            case "python":
                self.said = printed(body)
            case "python part":
                compile(body, "part", "exec")
            case "lisp" | "lisp wrong":
                _plan(body, right=kind == "lisp")
            case "toml":
                tomllib.loads(body)
            case "sql":
                import duckdb

                duckdb.sql(body)
            case _:
                raise PageError(f"a block of {kind or 'nothing'} that nobody runs: {body}")


def _text(body: str, said: str | None, some: bool) -> str:
    if body.startswith("$ "):
        return session(body)
    if said is None:
        raise PageError(f"a text that nothing prints:\n{body}")
    if not some:
        return said
    lines = iter(said.splitlines())
    for shown in body.splitlines():
        if not any(line.strip().startswith(shown.strip()) for line in lines):
            raise PageError(f"the page shows {shown!r}, which is not there, or not in this place:\n{said}")
    return body


def _plan(text: str, *, right: bool) -> None:
    try:
        compile_plan(Source("page.rplan", text), signatures())
    except PlanError as error:
        if right:
            raise PageError(f"a plan that does not compile: {error}") from error
        return
    if not right:
        raise PageError(f"a plan that should not compile:\n{text}")


def printed(program: str) -> str:
    """What a program prints."""
    stdout = io.StringIO()
    with redirect_stdout(stdout):
        exec(compile(program, "page", "exec"), {"__name__": "__page__"})
    return stdout.getvalue()


def session(text: str) -> str:
    """A session with every command run again."""
    parts = re.split(r"^\$ (.*)\n", text, flags=re.MULTILINE)[1:]
    return "".join(
        f"$ {command}\n{_again(command, said)}" for command, said in zip(parts[::2], parts[1::2], strict=True)
    )


def _again(command: str, said: str) -> str:
    now = _clean(run(command))
    return "" if not said and "rplan simulate" in command else now


def works(line: str) -> None:
    """Do what a line says; PageError where it cannot be done."""
    line = line.partition(" #")[0].strip()
    if any(part in line for part in ELSEWHERE):
        return
    for long, short in QUICK.items():
        line = line.replace(long, short)
    run(line)


def run(command: str) -> str:
    """What a line prints, on both streams. PageError where it is used wrongly."""
    given, _, called = command.rpartition(" | ")
    program, *arguments = shlex.split(called)
    match program:
        case "cd":
            os.chdir(arguments[0])
            return ""
        case "rplan":
            text = shlex.split(given)[1] + "\n" if given else None
            done = CliRunner().invoke(cli, arguments, input=text, env=PLAIN | {"COLUMNS": "100"})
            if done.exit_code not in (0, 1) or (done.exception and not isinstance(done.exception, SystemExit)):
                raise PageError(f"{command}: {done.output}{done.exception}")
            return done.output
        case "pytest":
            return _run([sys.executable, "-m", "pytest", *PLUGINS, *arguments])
        case "sed":
            return _run([program, *arguments])
    raise PageError(f"{command}: the reader has no {program}")


def _run(command: list[str]) -> str:
    kept = {
        name: value
        for name, value in os.environ.items()
        if not name.startswith(("PYTEST", "COV")) and name not in PLAIN
    }
    environment = kept | {"NO_COLOR": "1", "PYTHONPATH": str(ROOT), "COLUMNS": "80", "PYTHONDONTWRITEBYTECODE": "1"}
    environment |= {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "PYTHONUTF8": "1"}
    done = subprocess.run(command, capture_output=True, encoding="utf-8", env=environment, check=False)
    if done.returncode not in (0, 1):
        raise PageError(f"{shlex.join(command)}: {done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def _clean(text: str) -> str:
    for pattern, steady in MEASURED:
        text = pattern.sub(steady, text)
    lines = [line.rstrip() for line in text.strip("\n").splitlines()]
    return "".join(f"{line}\n" for line in lines)
