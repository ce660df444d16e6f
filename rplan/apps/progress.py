"""A bar that counts what has been done, on stderr, for commands that run many episodes.

Takes: how many there are, and a word for each that is done. Gives: the bar on a terminal, nothing where nobody looks.
Leaves alone: what is done.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn


@contextmanager
def counting(total: int, done: int = 0, said: str = "starting") -> Iterator[Callable[[str], None]]:
    """What is to be called whenever one more is done, with the words that stand beside the bar from then on."""
    console = Console(stderr=True)
    if not console.is_terminal or total == 0:
        yield _unseen
        return
    columns = (
        MofNCompleteColumn(),
        BarColumn(),
        TextColumn("{task.description}"),
        TimeElapsedColumn(),
        TextColumn("left:"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        shown = bar.add_task(said, total=total, completed=done)
        yield lambda now: bar.update(shown, advance=1, description=now)


def _unseen(_now: str) -> None:
    """Where nobody looks."""
