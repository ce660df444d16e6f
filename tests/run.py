"""All checks of the project, one after the other: `python tests/run.py`.

Takes: the checkout it lies in, and an interpreter with `rplan[dev]`. Gives: the output of every check, pytest last, and
exit code 1 if any of them failed. Leaves alone: what the checks ask; pyproject.toml has the settings of all of them.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]
TOOLS = Path(sys.executable).parent
PYTHON = sys.executable
CHECKS: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("lint", (PYTHON, "-m", "ruff", "check")),
    ("format", (PYTHON, "-m", "ruff", "format", "--check")),
    ("types", (PYTHON, "-m", "mypy")),
    ("imports", (str(TOOLS / "lint-imports"),)),
    ("tests", (PYTHON, "-m", "pytest", "-q", "-n", "2", "--cov", "--cov-report=term:skip-covered")),
)


def passes(name: str, command: tuple[str, ...], scratch: str) -> bool:
    """Run one check in the checkout; its output goes where ours goes, what was covered into the folder `scratch`."""
    print(f"== {name}", flush=True)
    begin = time.perf_counter()
    environment = os.environ | {"COVERAGE_FILE": str(Path(scratch) / "coverage")}
    code = subprocess.run(command, cwd=ROOT, env=environment, stdin=subprocess.DEVNULL, check=False).returncode
    if name != "tests":
        print(f"== {name}: {'passed' if code == 0 else 'FAILED'} in {time.perf_counter() - begin:.0f} s", flush=True)
    return code == 0


def main() -> int:
    """Every check, also after one has failed."""
    with tempfile.TemporaryDirectory() as scratch:
        failed = [name for name, command in CHECKS if not passes(name, command, scratch)]
    if failed:
        print(f"failed: {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
