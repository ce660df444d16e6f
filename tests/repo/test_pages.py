"""README and docs say what is so: links, paths, plans, commands and lists."""

from __future__ import annotations

import re
from pathlib import Path

from click import Context

from rplan.apps.cli import COMMANDS, cli
from rplan.apps.wiring import signatures
from rplan.driver import compile_plan
from rplan.lang.source import Source

Pages = dict[Path, str]

LINK = re.compile(r"\]\(([^)\s]+)\)")
BLOCK = re.compile(r"^```lisp\n(.*?)^```$", re.MULTILINE | re.DOTALL)
QUOTED = re.compile(r"`([^`\n]+)`")


def prose(text: str) -> str:
    """A page without its code blocks."""
    return re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)


def anchors(text: str) -> set[str]:
    """The anchors of the headings of a page, as forges make them."""
    heads = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


def test_every_link_leads_to_a_file_and_a_heading(pages: Pages) -> None:
    assert len(pages) > 10
    broken = []
    for page, text in pages.items():
        for link in LINK.findall(prose(text)):
            if link.startswith("https://"):
                continue
            name, _, anchor = link.partition("#")
            target = (page.parent / name).resolve() if name else page
            if not target.exists() or (anchor and anchor not in anchors(target.read_text(encoding="utf-8"))):
                broken.append(f"{page.name}: {link}")
    assert broken == []


def test_every_page_of_the_docs_is_reached_from_the_readme(pages: Pages, root: Path) -> None:
    seen: list[Path] = []
    ahead = [root / "README.md"]
    while ahead:
        page = ahead.pop()
        if page in seen or page not in pages:
            continue
        seen.append(page)
        links = (link.partition("#")[0] for link in LINK.findall(prose(pages[page])))
        ahead += [(page.parent / link).resolve() for link in links if link and not link.startswith("https://")]
    assert [page.name for page in pages if page not in seen] == []


def test_every_path_that_the_architecture_names_exists(root: Path) -> None:
    text = (root / "docs" / "ARCHITECTURE.md").read_text(encoding="utf-8")
    named = [name for name in QUOTED.findall(text) if re.fullmatch(r"[\w.\-/*]+", name) and "/" in name]
    assert len(named) > 40
    assert [name for name in named if not any(root.glob(name.rstrip("/")))] == []


def test_every_whole_plan_on_a_page_compiles(pages: Pages) -> None:
    """A `lisp` block with a top goal is a whole plan; one that is meant to be wrong is a block `lisp wrong`."""
    compiled = 0
    for page, text in pages.items():
        for plan in BLOCK.findall(text):
            if "(goalem" in plan:
                compile_plan(Source(f"{page.name}.rplan", plan), signatures())
                compiled += 1
    assert compiled >= 5


def test_the_readme_explains_a_plan_that_stands_in_a_file(pages: Pages, root: Path) -> None:
    blocks = [plan for plan in BLOCK.findall(pages[root / "README.md"]) if "(goalem" in plan]
    assert blocks == [(root / "plans" / "make_room" / "make_room.rplan").read_text(encoding="utf-8")]


def test_every_command_has_a_section(pages: Pages, root: Path) -> None:
    heads = re.findall(r"^## rplan ([\w-]+)$", pages[root / "docs" / "reference" / "commands.md"], re.MULTILINE)
    assert heads == list(COMMANDS)


def test_every_option_of_every_command_is_on_its_page(pages: Pages, root: Path) -> None:
    page = pages[root / "docs" / "reference" / "commands.md"]
    sections = dict(re.findall(r"^## rplan ([\w-]+)\n(.*?)(?=^## |\Z)", page, re.MULTILINE | re.DOTALL))
    missing = [
        f"{name} {option}" for name in COMMANDS for option in options_of(name) if f"`{option}" not in sections[name]
    ]
    assert missing == []


def options_of(name: str) -> list[str]:
    """The long options of a command."""
    command = cli.get_command(Context(cli), name)
    assert command is not None
    return [next(o for o in p.opts if o.startswith("--")) for p in command.params if p.param_type_name == "option"]


def test_every_rule_of_the_language_is_pinned_by_a_test(texts: dict[Path, str], root: Path) -> None:
    rules = re.findall(r"^- \*\*(L\d+)\*\*", texts[root / "docs" / "reference" / "language.md"], re.MULTILINE)
    assert len(rules) == len(set(rules)) > 20
    marked = {
        rule
        for path, text in texts.items()
        if path.name.startswith("test_")
        for rule in re.findall(r"mark\.rule\(\"(L\d+)\"", text)
    }
    assert [rule for rule in rules if rule not in marked] == []
