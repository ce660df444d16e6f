"""What makes a site of the pages as they lie in the folder, where they also read well without one.

Takes: the pages of docs/, and README.md, CHANGELOG.md and files of the project that pages link to. Gives: all of
them as pages of the site, links that lead there, and the navigation. Leaves alone: what pages say.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import plan_lexer
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).parents[2]
LINK = re.compile(r"(?<=\]\()(?!https?:|mailto:|#)([^)\s#]+)(?=[)#])")
FENCE = re.compile(r"(^```.*?^```$)", re.MULTILINE | re.DOTALL)
HOME = {"README.md": "index.md", "CHANGELOG.md": "changes.md"}
SOURCES = "sources"
KINDS = {".rplan": "rplan", ".py": "python", ".yaml": "yaml", ".toml": "toml", ".json": "json"}
SECTIONS = (
    ("Tutorial", "tutorial"),
    ("How to", "how-to"),
    ("Reference", "reference"),
    ("Explanation", "explanation"),
    ("Decisions", "decisions"),
    ("Experiments", "experiments"),
)
ALONE = {"explanation": ["ARCHITECTURE.md"], "experiments": ["experiments.md"]}
"""Pages at the top of docs/ that belong to a section."""


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """The navigation is what lies in the folders."""
    plan_lexer.register()
    docs = Path(config.docs_dir)
    sections = [{title: [*ALONE.get(folder, []), *_pages(docs, folder)]} for title, folder in SECTIONS]
    config.nav = [{"rplan": ["index.md", "changes.md"]}, *sections]
    return config


def _pages(docs: Path, folder: str) -> list[str]:
    found = sorted((docs / folder).glob("*.md"), key=lambda path: (path.name != "README.md", path.name))
    return [f"{folder}/{path.name}" for path in found]


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Bring in what lies outside of docs/: the first page, the changes, and every file that a page links to."""
    pages = {name: (ROOT / name).read_text(encoding="utf-8") for name in HOME}
    pages |= {f"docs/{file.src_uri}": file.content_string for file in files.documentation_pages()}
    linked = {target for name, text in pages.items() for target in _targets(name, text) if _is_source(target)}
    for name in HOME:
        files.append(File.generated(config, HOME[name], content=_linked(name, pages[name])))
    for target in sorted(linked):
        files.append(File.generated(config, _on_site(target), content=_shown(target)))
    return files


def on_page_markdown(markdown: str, page: Any, **_: object) -> str:
    """Links that leave docs/ lead to pages of the site, and blocks get colours."""
    source = page.file.src_uri
    known = source in HOME.values() or source.startswith(f"{SOURCES}/")
    return _coloured(markdown if known else _linked(f"docs/{source}", markdown))


def _coloured(markdown: str) -> str:
    markdown = re.sub(r"^```lisp(?: wrong)?(?=$| title)", "```rplan", markdown, flags=re.MULTILINE)
    markdown = re.sub(r"^( *)```python part$", r"\1```python", markdown, flags=re.MULTILINE)
    return re.sub(r"^```(?:text|sh)\n(?=\$ )", "```console\n", markdown, flags=re.MULTILINE)


# --- links ----------------------------------------------------------------------------------------------


def _targets(name: str, text: str) -> Iterator[str]:
    """The files of the project that a page links to."""
    for part in FENCE.split(text)[::2]:
        for link in LINK.findall(part):
            yield posixpath.normpath(posixpath.join(posixpath.dirname(name), link))


def _is_source(target: str) -> bool:
    return not target.startswith("docs/") and target not in HOME and (ROOT / target).is_file()


def _on_site(target: str) -> str:
    """Where a file of the project is on the site; what is nowhere stays as it is, and the build complains."""
    if target.startswith("docs/"):
        return target.removeprefix("docs/")
    return HOME.get(target) or (f"{SOURCES}/{target}.md" if _is_source(target) else target)


def _linked(name: str, text: str) -> str:
    """The page with its links as they are on the site."""
    here = posixpath.dirname(_on_site(name)) or "."

    def moved(link: re.Match[str]) -> str:
        target = posixpath.normpath(posixpath.join(posixpath.dirname(name), link[1]))
        return posixpath.relpath(_on_site(target), here)

    parts = FENCE.split(text)
    return "".join(LINK.sub(moved, part) if number % 2 == 0 else part for number, part in enumerate(parts))


def _shown(target: str) -> str:
    """A file of the project as a page."""
    path = ROOT / target
    text = path.read_text(encoding="utf-8").rstrip("\n")
    kind = KINDS.get(path.suffix, "text")
    return f"# {path.name}\n\n`{target}`\n\n```{kind}\n{text}\n```\n"
