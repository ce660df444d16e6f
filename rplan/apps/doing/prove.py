"""What `rplan prove` does.

Takes: a plan. Gives: what it promises, proven or broken, with a trace that breaks it. Leaves alone: options and their
help; see rplan/apps/commands/prove.py, which imports this only when there is something to do.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from time import perf_counter

import click

from rplan.apps import talk
from rplan.apps.files import InputError, plan_file, unreadable
from rplan.driver import Compiled
from rplan.ways.prove import Promise, Proof, promises, prove
from rplan.ways.reach import Reach
from rplan.ways.situations import describe, lines, replay
from rplan.ways.way import taken_way

Timed = tuple[Proof, float]


def run(plan: str, names: tuple[str, ...], trace: str | None, as_json: bool) -> None:
    """Do what was asked; leaves with the exit code of the command."""
    compiled = talk.compiled(plan_file(plan), allow_holes=True, as_json=as_json)
    reach = Reach(compiled.ways)
    proofs = [_timed(reach, promise) for promise in _chosen(promises(compiled.ways), names)]
    refuted = [proof for proof, _ in proofs if proof.verdict == "refuted"]
    if trace is not None and refuted:
        _write(Path(trace), lines(refuted[0].trace))
    if as_json:
        talk.result({"plan": compiled.goals.name, "properties": [_plain(*one) for one in proofs]})
    else:
        _say(compiled, proofs)
    if refuted:
        raise SystemExit(talk.PLAN_IS_WRONG)


def _timed(reach: Reach, promise: Promise) -> Timed:
    begin = perf_counter()
    proof = prove(reach, promise)
    return proof, perf_counter() - begin


def _chosen(every: Sequence[Promise], names: Sequence[str]) -> list[Promise]:
    known = [promise.name for promise in every]
    for name in names:
        if name not in known:
            raise InputError(f"there is no property {name} (there are: {', '.join(known) or 'none'})")
    return [promise for promise in every if not names or promise.name in names]


def _write(path: Path, trace: Sequence[str]) -> None:
    try:
        path.write_text("".join(f"{line}\n" for line in trace), encoding="utf-8")
    except OSError as error:
        unreadable(path, error)


def _plain(proof: Proof, seconds: float) -> dict[str, object]:
    return {
        "name": proof.promise.name,
        "doc": proof.promise.doc,
        "claim": proof.promise.claim,
        "place": talk.place(proof.promise.span),
        "verdict": proof.verdict,
        "vacuous": proof.vacuous,
        "trace": [dict(tick) for tick in proof.trace],
        "seconds": round(seconds, 3),
    }


def _say(compiled: Compiled, proofs: Sequence[Timed]) -> None:
    if not proofs:
        click.echo(f"{compiled.goals.name}: the plan promises nothing (say `(defproperty NAME :always CONDITION)`)")
        return
    for proof, seconds in proofs:
        empty = ", but emptily: it asks for what can never be" if proof.vacuous else ""
        click.echo(f"{proof.promise.name}: {proof.verdict}{empty} ({seconds:.2f} s)")
        click.echo(f"  {proof.promise.claim}")
        if proof.verdict == "refuted":
            _broken(compiled, proof)
    counts = [(sum(p.verdict == word for p, _ in proofs), word) for word in ("proven", "refuted", "unknown")]
    click.echo(", ".join(f"{count} {word}" for count, word in counts if count))


def _broken(compiled: Compiled, proof: Proof) -> None:
    click.echo(f"  broken when {describe(proof.trace, compiled.ways)}")
    seen = replay(compiled.ways, proof.trace)
    way = taken_way(compiled.ways, seen.atoms, seen.registers)
    if way.hole:
        click.echo("  no way is open then")
    for act in way.acts:
        click.echo(f"  {act.span}: {act.rule} sets {act.output} to {act.value}")
    for given in way.given_up:
        click.echo(f"  {given.span}: {given.member} is given up: {given.because}")
