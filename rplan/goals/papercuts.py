"""Small checks on a reduced goal: channels that fight over an actuator, and channels that are read too early or
are never set (L25).

Takes: the reduced goal, the outputs in their order and the scope. Gives: findings. Leaves alone: everything that needs
to know which situations can be; see rplan/ways/coverage.py.
"""

from __future__ import annotations

from rplan.goals.condition import Term
from rplan.goals.goal import Do, Goal, Output, walk
from rplan.goals.scope import Scope
from rplan.lang.diagnostic import Related


def check_channels(top: Goal, outputs: tuple[Output, ...], scope: Scope) -> None:
    """Two command channels for one actuator are an error; reading a later channel or one never set is a warning."""
    order = {output.name: index for index, output in enumerate(outputs)}
    filled = dict.fromkeys(output for output, _ in _values(top, outputs))
    filled |= dict.fromkeys(output.name for output in outputs if output.initial is not None)
    drivers: dict[str, tuple[str, Term]] = {}
    for output, term in _values(top, outputs):
        function = scope.functions.get(term.name) if term.kind == "call" else None
        if function is None:
            continue
        for actuator in function.actuators:
            first, other = drivers.setdefault(actuator, (output, term))
            if first != output:
                scope.findings.add(
                    "error", "two-channels",
                    f"`{first}` and `{output}` both drive the actuator `{actuator}`", term.span,
                    related=[Related(f"`{other.text}` drives it in `{first}`", other.span)],
                    hint="let one channel drive it",
                )  # fmt: skip
        for channel in function.reads:
            if channel not in filled:
                scope.findings.add(
                    "warning", "reads-unset-channel",
                    f"`{term.text}` reads the channel `{channel}`, which nothing sets", term.span,
                    hint=f"set it in the same tick: `(do {channel} VALUE)`",
                )  # fmt: skip
            if channel in order and order[channel] > order[output]:
                scope.findings.add(
                    "warning", "reads-later-channel",
                    f"`{term.text}` reads the channel `{channel}`, which is filled after `{output}`: it sees last "
                    "tick's value",
                    term.span, hint=f"declare `{channel}` before `{output}`",
                )  # fmt: skip


def _values(top: Goal, outputs: tuple[Output, ...]) -> list[tuple[str, Term]]:
    idle = [(output.name, output.idle) for output in outputs if output.idle is not None]
    return [(node.output, node.value) for node in walk(top) if isinstance(node, Do)] + idle
