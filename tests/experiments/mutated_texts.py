"""Mutated plan texts: each is a plan or a `PlanError`, never another fault, never slow.

Run by hand: `python tests/experiments/mutated_texts.py --texts 100000`. Texts are of a grammar of plans, with
slips in them, and from real plans with bytes changed, dropped, doubled and moved. Prints how many were plans, how many
were not, and the slowest; exit code 1 if one raised anything else or took longer than `--most` seconds.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from time import perf_counter

import numpy as np
from hypothesis import HealthCheck, Phase, given, seed, settings

from rplan.apps.wiring import compile_source
from rplan.lang.diagnostic import PlanError
from rplan.lang.source import Source
from rplan.ways.coverage import review

ROOT = Path(__file__).parents[2]
CHUNK = 1_000
sys.path.insert(0, str(ROOT / "tests"))

from properties.strategies_lang import mutated_texts  # noqa: E402


class Count:
    """What came of the texts so far."""

    def __init__(self, most: float) -> None:
        self.most = most
        self.plans = self.errors = 0
        self.slowest = 0.0
        self.faults: list[str] = []

    def take(self, text: str) -> None:
        """Compile one text and check it."""
        begin = perf_counter()
        try:
            compile_source(Source("mutated.rplan", text), allow_holes=True, checks=review)
            self.plans += 1
        except PlanError:
            self.errors += 1
        except Exception as error:
            self.faults.append(f"{type(error).__name__}: {error}\n{text}")
        seconds = perf_counter() - begin
        self.slowest = max(self.slowest, seconds)
        if seconds > self.most:
            self.faults.append(f"{seconds:.1f} s\n{text}")


def by_grammar(number: int, first_seed: int) -> Iterator[str]:
    """Texts of Hypothesis' grammar with slips in them.

    Drawn a thousand at a time and handed out afterwards: what Hypothesis keeps of its examples does not weigh on the
    times that are taken.
    """
    for at in range(0, number, CHUNK):
        yield from _drawn(min(CHUNK, number - at), first_seed + at // CHUNK)


def _drawn(number: int, chance: int) -> list[str]:
    texts: list[str] = []

    @seed(chance)
    @settings(
        max_examples=number,
        deadline=None,
        database=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(mutated_texts())
    def draw(text: str) -> None:
        texts.append(text)

    draw()
    return texts


def by_bytes(number: int, chance: np.random.Generator) -> Iterator[str]:
    """Real plans with noise in their bytes."""
    plans = [path.read_bytes() for path in sorted(ROOT.glob("plans/*/*.rplan"))]
    for _ in range(number):
        text = bytearray(plans[int(chance.integers(len(plans)))])
        for _ in range(int(chance.integers(1, 6))):
            at = int(chance.integers(len(text)))
            end = min(len(text), at + int(chance.integers(1, 30)))
            match int(chance.integers(5)):
                case 0:
                    text[at] = int(chance.integers(256))
                case 1:
                    del text[at:end]
                case 2:
                    text[at:at] = text[at:end]
                case 3:
                    text[at:at] = bytes([b'()";:?#|0.'[int(chance.integers(10))]])
                case _:
                    to = int(chance.integers(len(text)))
                    text[to:to] = text[at:end]
        yield text.decode("utf-8", errors="replace")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--texts", type=int, default=2_000)
    parser.add_argument("--most", type=float, default=2.0)
    parser.add_argument("--seed", type=int, default=0)
    wanted = parser.parse_args()
    count = Count(wanted.most)
    half = wanted.texts // 2
    noisy = by_bytes(wanted.texts - half, np.random.default_rng(wanted.seed))
    for text in chain(by_grammar(half, wanted.seed), noisy):
        count.take(text)
    print(f"{count.plans + count.errors:,} texts: {count.plans:,} plans, {count.errors:,} with errors")
    print(f"slowest {count.slowest:.2f} s; {len(count.faults)} faults of rplan's own or slower than {wanted.most:g} s")
    for fault in count.faults[:5]:
        print(fault)
    return 1 if count.faults else 0


if __name__ == "__main__":
    sys.exit(main())
