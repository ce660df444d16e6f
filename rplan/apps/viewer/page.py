"""A recording as a page that knows its plan.

Takes: a recording and where to write. Gives: the page of sim/replay.py with the circuit and with the goals that lost;
where the plan cannot be compiled again, the page without them. Leaves alone: how it looks.
"""

from __future__ import annotations

from pathlib import Path

from rplan.apps.libraries import Catalogue
from rplan.apps.viewer.telling import telling
from sim.recording import Recording
from sim.replay import write_replay


def write_page(recording: Recording, path: Path, verdict: str = "", libraries: Catalogue | None = None) -> str:
    """Write the page; gives why it has no circuit, "" if it has.

    Raises OSError where it cannot be written, RecordingError where the recording is damaged.
    """
    told, why_not = telling(recording.header, libraries)
    write_replay(recording, path, verdict, told)
    return why_not
