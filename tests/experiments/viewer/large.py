"""A plan of 200 rules whose circuit is too large to be drawn whole: parts of it are, and their wires are live.

Takes: a browser and a folder. Gives: points. Leaves alone: whether the cut is right; the tests ask that of the rule
that the page follows too.
"""

from __future__ import annotations

from viewer.inspected import FETCH


def remembering(rules: int) -> str:
    """Find and fetch with so many rules; those beside its own ask for how long something held, and what was before."""
    text = FETCH.read_text(encoding="utf-8")
    head, goal = text[: text.index("(defgoalr")], text[text.index("(defgoalr") :]
    percepts = ["there-is-a-goal", "we-are-at-the-goal", "donor-has-been-located", "anything-is-too-close"]
    names = [f"report-{k:03}" for k in range(rules - goal.count("(defgoalr"))]
    outputs = "".join(f"(defoutput {name} bool :idle false)\n" for name in names)
    bodies = "".join(
        f"(defgoalr (ach {name})\n  (if (or (held-for {k % 20 / 10 + 0.2:.1f}s ({percepts[k % 4]}))\n"
        f"          (latch ({percepts[(k + 1) % 4]}) (held-for {k % 24 / 10 + 0.3:.1f}s ({percepts[(k + 2) % 4]}))))\n"
        f"      (do {name} true)\n      (do anything)))\n\n"
        for k, name in enumerate(names)
    )
    more = "".join(f"\n                  (ach {name})" for name in names)
    return f"{head}{outputs}\n{goal.replace('(goalem', f'{bodies}(goalem').removesuffix('))' + chr(10))}{more}))\n"
