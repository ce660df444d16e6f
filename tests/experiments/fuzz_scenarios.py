"""Mutated scenarios: each is a world that runs or a `ScenarioError`, never another fault, never slow, never large.

Run by hand: `python tests/experiments/fuzz_scenarios.py --texts 25000`. Texts are the scenarios that come with rplan
and a yard with one of everything, with bytes, words, numbers and lines changed, dropped, doubled and exchanged. What
is read is laid out and run for five ticks. Prints the counts, the slowest and the peak of memory; exit code 1 if one
raised anything else or took longer than `--most` seconds.
"""

from __future__ import annotations

import argparse
import re
import resource
import sys
from pathlib import Path
from time import perf_counter

import numpy as np

from behaviours.interface import Command, Drive
from sim.scenarios.format import loads
from sim.scenarios.schema import ScenarioError
from sim.world import World

ROOT = Path(__file__).parents[2]
YARD = """
name: yard
bounds: [-6, -6, 6, 6]
robot:
  start: [0, 0]
  shape: {box: [0.6, 0.4]}
  drive: {kind: skid-steer, slip: 1.2}
  sensors:
    - {kind: lidar, at: [0.2, 0, 5 deg], beams: 181, field_of_view: 180 deg, latency: 0.2}
    - {kind: sonar, name: ring}
    - {kind: compass}
    - {kind: gps, period: 0.5}
    - {kind: bumper}
    - {kind: currents}
goal: {at: [4, 4], within: 50 cm, no_contact: true}
ground: [{region: [0, 0, 3, 3], rise: 5 deg, uphill: 30 deg}]
weather: {sun: 20 deg, jitter: 1 deg, gusts: 0.1}
things:
  - {kind: wall, from: [-6, -6], to: [6, -6]}
  - {kind: curb, from: [1.5, -2], to: [1.5, 2], height: 0.06}
  - {kind: cart, at: [0, 1.2], id: cart}
  - {kind: person, track: [[-3, -3], [3, -3]]}
  - {kind: disc, radius: 0.4, id: bin, keyframes: [[0, -3, 3], [10, 3, 3], [20, -3, 3]]}
  - {kind: polygon, vertices: [[0, 0], [1, 0], [0, 1]], at: [3, -3], mass: 4}
  - {kind: outline, rings: ["-5 4, -4 4, -4 5, -5 5", [[-4.8, 4.2], [-4.8, 4.8], [-4.2, 4.8]]]}
events: [{at: 0.2, vanish: bin}, {at: 0.3, put: {thing: bin, at: [2, 2, 1]}}]
faults: [{sensor: lidar, kind: dropout, at: 0, until: 15, amount: 0.3}]
scatter: [{kinds: [post, trashcan], count: [3, 6], region: [-5, -5, 5, 5], min_gap: 1}]
"""
NUMBERS = ("0", "-1", "1e9", "1e-9", "1e308", "-1e308", ".nan", ".inf", "7 deg", "3 min", "99999999999", "0.5", "1e5")
TOKEN = re.compile(r"[A-Za-z_-]+|[-+.\d]+|\s+|.", re.DOTALL)


def mutated(text: str, chance: np.random.Generator) -> str:
    """The text with a few changes."""
    for _ in range(int(chance.integers(1, 4))):
        tokens = TOKEN.findall(text) or [" "]
        at, other = (int(chance.integers(len(tokens))) for _ in range(2))
        match int(chance.choice([0, 0, 0, 0, 0, 0, 1, 2, 3, 4, 5, 6])):
            case 0:
                numbers = [index for index, token in enumerate(tokens) if token[-1].isdigit()] or [at]
                tokens[numbers[at % len(numbers)]] = NUMBERS[int(chance.integers(len(NUMBERS)))]
            case 1:
                del tokens[at : at + int(chance.integers(1, 20))]
            case 2:
                tokens[at:at] = tokens[at : at + int(chance.integers(1, 40))]
            case 3:
                tokens[at], tokens[other] = tokens[other], tokens[at]
            case 4:
                tokens[at] = chr(int(chance.integers(1, 0x2FF)))
            case 5:
                tokens[at] = "[{]},:&*!|>'\"%@`#-"[int(chance.integers(18))]
            case _:
                lines = text.splitlines(keepends=True)
                first = int(chance.integers(len(lines))) if lines else 0
                tokens = [*lines[:first], *lines[first : first + 2], *lines[first:]]
        text = "".join(tokens)
    return text


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--texts", type=int, default=1_000)
    parser.add_argument("--most", type=float, default=2.0)
    parser.add_argument("--seed", type=int, default=0)
    wanted = parser.parse_args()
    chance = np.random.default_rng(wanted.seed)
    texts = [path.read_text() for path in sorted(ROOT.glob("plans/*/*.yaml"))] + [YARD]
    worlds = refused = 0
    slowest, faults = 0.0, list[str]()
    for number in range(wanted.texts):
        text = mutated(texts[number % len(texts)], chance)
        begin = perf_counter()
        try:
            world = World(loads(text), seed=number)
            for _ in range(5):
                world.step(Command(Drive(0.3, 0.2)))
            worlds += 1
        except ScenarioError:
            refused += 1
        except Exception as error:
            faults.append(f"{type(error).__name__}: {error}\n{text}")
        seconds = perf_counter() - begin
        slowest = max(slowest, seconds)
        if seconds > wanted.most:
            faults.append(f"{seconds:.1f} s\n{text}")
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"{wanted.texts:,} texts: {worlds:,} worlds, {refused:,} refused")
    print(f"slowest {slowest:.2f} s, peak of memory {memory:,.0f} MiB; {len(faults)} other faults or slower")
    for fault in faults[:5]:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
