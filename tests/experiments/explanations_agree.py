"""Random plans: every explanation of their ticks is as trying every combination of percepts says.

Run by hand: `python tests/experiments/explanations_agree.py --plans 2000`. The literals of `why` are the smallest set,
the first in order of those as small; the changes of `why-not` make it happen, in the circuit too, and no fewer do;
what no percepts change is held by what is kept, or never is. Chance is numpy's, from `--seed`. Prints what was
compared, and stops with exit code 1 at the first plan that differs, with its text.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from properties.explanations import Asker, Trial, differs, usable, wishes

from rplan.ways.why_not import Changes


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--plans", type=int, default=100)
    parser.add_argument("--ticks", type=int, default=2)
    parser.add_argument("--seed", type=int, default=0)
    wanted = parser.parse_args()
    chance = np.random.default_rng(wanted.seed)
    asker = Asker(chance)
    plans, ticks, verdicts = 0, 0, Counter[str]()
    while plans < wanted.plans:
        text = asker.plan()
        trial = Trial(text)
        if not usable(trial):
            continue
        plans += 1
        *_, tick = trial.random(chance, wanted.ticks + plans % 3)
        said = differs(trial, tick)
        if said:
            print(f"plan {plans} differs: {said}\n{text}{tick.values}")
            return 1
        verdicts.update(
            Changes(trial.ways, one).why_not(tick.atoms, tick.registers).verdict for one in wishes(trial.ways)
        )
        ticks += 1
    print(f"{plans:,} plans, a tick of each: every `why` and every `why-not` is as the reference says")
    print("why-not: " + ", ".join(f"{count:,} {verdict}" for verdict, count in sorted(verdicts.items())))
    return 0


if __name__ == "__main__":
    sys.exit(main())
