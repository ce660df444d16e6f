"""The site builds in strict mode: no link and no anchor leads nowhere. It has every page, and asks no other host."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

OTHERS = re.compile(r"<(?:script|link|img|iframe|source)\b[^>]*?(?:src|href)=[\"']?(?:https?:)?//", re.IGNORECASE)
BLOCK = re.compile(r'<div class="language-(\w+) highlight">')


def build(root: Path, folder: Path, *options: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "-f", "docs/site/mkdocs.yml", "-d", str(folder)]
    environment = os.environ | {"NO_MKDOCS_2_WARNING": "1", "NO_COLOR": "1", "PYTHONDONTWRITEBYTECODE": "1"}
    return subprocess.run([*command, *options], cwd=root, env=environment, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def site(root: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    done = build(root, folder)
    assert done.returncode == 0, done.stderr
    return folder


def html(site: Path) -> dict[str, str]:
    return {
        path.relative_to(site).as_posix(): path.read_text(encoding="utf-8") for path in sorted(site.rglob("*.html"))
    }


def test_every_page_of_the_docs_is_on_the_site(site: Path, root: Path) -> None:
    pages = [path.relative_to(root / "docs") for path in sorted((root / "docs").rglob("*.md"))]
    wanted = [page.with_name("index.html" if page.name == "README.md" else f"{page.stem}.html") for page in pages]
    assert len(wanted) > 40
    assert [str(page) for page in wanted if not (site / page).is_file()] == []


def test_the_first_page_is_the_readme_and_its_links_stay_on_the_site(site: Path, root: Path) -> None:
    first = (site / "index.html").read_text(encoding="utf-8")
    assert 'href="tutorial/1_first_plan.html"' in first
    assert 'href="sources/plans/make_room/make_room.rplan.html"' in first
    assert 'href="docs/' not in first


def test_no_page_asks_another_host_for_anything(site: Path) -> None:
    assert [name for name, text in html(site).items() if OTHERS.search(text)] == []
    assert [path.name for path in site.rglob("*.css") if "//fonts." in path.read_text(encoding="utf-8")] == []


def test_every_block_is_one_and_plans_have_colours(site: Path) -> None:
    pages = html(site)
    assert [name for name, text in pages.items() if "<p>```" in text or "<code>lisp" in text] == []
    kinds = {kind for text in pages.values() for kind in BLOCK.findall(text)}
    assert {"rplan", "console", "python", "yaml", "text"} <= kinds
    assert '<span class="kd">goalem</span>' in pages["tutorial/1_first_plan.html"]


def test_the_navigation_has_the_six_steps_in_their_order(site: Path) -> None:
    page = (site / "tutorial" / "1_first_plan.html").read_text(encoding="utf-8")
    order = [page.index(f'href="{step}_') for step in range(2, 7)]
    assert order == sorted(order)


@pytest.mark.parametrize("link", ["nowhere.md", "commands.md#nothing", "../../plans/none.rplan"])
def test_a_link_that_leads_nowhere_stops_the_build(link: str, root: Path, tmp_path: Path) -> None:
    for name in ("docs", "README.md", "CHANGELOG.md", "LICENSE", "plans"):
        (tmp_path / name).symlink_to(root / name)
    (tmp_path / "docs").unlink()
    for name in ("site", "reference", "tutorial"):
        (tmp_path / "docs" / name).mkdir(parents=True)
        for path in sorted((root / "docs" / name).iterdir()):
            if path.is_file():
                (tmp_path / "docs" / name / path.name).write_bytes(path.read_bytes())
    (tmp_path / "docs" / "reference" / "broken.md").write_text(f"# Broken\n\n[There]({link}).\n", encoding="utf-8")
    done = build(tmp_path, tmp_path / "out")
    assert done.returncode != 0
    assert any("broken.md" in line and link.partition("#")[2] in line for line in done.stderr.splitlines())
