"""A run is the same in another process with another hash seed."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
PROGRAM = """
import hashlib, json
from pathlib import Path
from behaviours.interface import Command, Drive
from sim.episode import Episode
from sim.scenarios.format import load

episode, sha = Episode(load(Path("plans/find_and_fetch/parking_lot.yaml")), 11), hashlib.sha256()
for _ in range(300):
    episode.world.step(Command(Drive(0.2, 0.1)))
    sha.update(json.dumps(episode.snapshot()).encode())
    sha.update(repr(episode.world.robot.pose).encode())
print(sha.hexdigest())
"""


def test_two_processes_with_two_hash_seeds_agree():
    outputs = [
        subprocess.run(
            [sys.executable, "-c", PROGRAM],
            cwd=ROOT,
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": str(ROOT)},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    ]
    assert outputs[0] == outputs[1] != ""
