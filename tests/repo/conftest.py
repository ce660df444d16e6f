"""The project as files: what tests of the repository walk over.

Takes: the checkout. Gives: its root and its own text files. Leaves alone: what tools leave behind in it.
"""

from __future__ import annotations

from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FILES = ("pyproject.toml", "README.md", "CHANGELOG.md", "LICENSE", ".gitignore")
FOLDERS = (".ci", "rplan", "behaviours", "sim", "plans", "tests", "docs")
TEXTS = {".py", ".md", ".toml", ".yaml", ".rplan", ".txt", ".lark", ".html", ""}


def _own(suffixes: set[str]) -> list[Path]:
    files = [ROOT / name for name in FILES] + [path for name in FOLDERS for path in (ROOT / name).rglob("*")]
    return sorted(p for p in files if p.is_file() and p.suffix in suffixes and "__pycache__" not in p.parts)


@pytest.fixture(scope="session")
def root() -> Path:
    """The folder of pyproject.toml."""
    return ROOT


@pytest.fixture(scope="session")
def texts() -> dict[Path, str]:
    """Every text file that the project is made of."""
    return {path: path.read_text(encoding="utf-8") for path in _own(TEXTS)}


@pytest.fixture(scope="session")
def pages(texts: dict[Path, str]) -> dict[Path, str]:
    """The Markdown pages."""
    return {path: text for path, text in texts.items() if path.suffix == ".md"}
