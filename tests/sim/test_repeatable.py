"""A run is the same to the byte in another process with another hash seed; another seed makes another run."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROGRAM = """
import hashlib, sys
from pathlib import Path
from behaviours.interface import Command, Drive
from sim.environment import Environment
from sim.scenarios.format import load

scenario, seed, place = load(Path(sys.argv[1])), int(sys.argv[2]), Path(sys.argv[3])
with Environment(scenario, record=place) as environment:
    environment.reset(seed)
    for tick in range(300):
        environment.step(Command(Drive(0.2, 0.1 if tick % 100 < 50 else -0.2)))
print(hashlib.sha256(place.read_bytes()).hexdigest())
"""
YARD = """
name: yard
bounds: [-6, -6, 6, 6]
robot: {model: packbot, start: [0, 0], heading: {between: [0, 6]}}
weather: {sun: 20 deg}
ground: [{region: [0, 0, 3, 3], rise: 5 deg, uphill: 30 deg}]
things:
  - {kind: wall, from: [-6, -6], to: [6, -6]}
  - {kind: curb, from: [1.5, -2], to: [1.5, 2], height: 0.06}
  - {kind: cart, at: [0, 1.2], id: cart}
  - {kind: person, track: [[-3, -3], [3, -3]]}
  - {kind: disc, radius: 0.4, id: bin, keyframes: [[0, -3, 3], [10, 3, 3], [20, -3, 3]]}
events: [{at: 12, vanish: bin}]
faults: [{sensor: lidar, kind: dropout, at: 5, until: 15, amount: 0.3}]
scatter: [{kinds: [post, trashcan], count: [3, 6], region: [-5, -5, 5, 5], min_gap: 1}]
"""


@pytest.fixture(params=["the parking lot", "a yard"])
def scenario(request, tmp_path) -> Path:
    if request.param == "the parking lot":
        return ROOT / "plans" / "find_and_fetch" / "parking_lot.yaml"
    (tmp_path / "yard.yaml").write_text(YARD)
    return tmp_path / "yard.yaml"


def digest(scenario: Path, seed: int, hash_seed: int, place: Path) -> str:
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(scenario), str(seed), str(place)],
        cwd=ROOT,
        env={**os.environ, "PYTHONHASHSEED": str(hash_seed), "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout


def test_recordings_of_three_processes_are_equal_and_those_of_another_seed_are_not(scenario, tmp_path):
    place = tmp_path / "run.mcap"
    first, second, third = (digest(scenario, 11, hash_seed, place) for hash_seed in (0, 1, 2))
    assert first == second == third != ""
    assert digest(scenario, 12, 0, place) != first
