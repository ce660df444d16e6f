"""Keeping to a side: the spin of a group that stands is locked until going round it has paid.

Takes: the plan, the distance to the goal, and the locks so far. Gives: the locks after it, and what the next plan
inherits. Leaves alone: which groups move (they are not locked), and how a spin is chosen.

The rule to leave is that of TangentBug (Kamon, Rivlin and Rimon 1998): an obstacle is followed until the goal can be
approached nearer than the nearest point since it was met. With it no obstacle is met again from the same place.
A side that leads too far from the goal is given up for the other, and each time it may lead twice as far: what is lost
by a wrong side is then at most a multiple of what the right one costs.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

from behaviours.cores.nat import Group, Memory, NatPlan, Spin, opposite


@dataclass(frozen=True, slots=True)
class CommitmentSettings:
    """leave_by [m]: so much nearer to the goal than where the group was met the robot must be to leave it.

    detour [m]: so much farther from the goal than there the robot may come before it tries the other side.
    """

    leave_by: float = 0.3
    detour: float = 5.0


@dataclass(frozen=True, slots=True)
class Lock:
    """A spin, how near to the goal [m] the robot was when it was locked, and how much farther it may come."""

    spin: Spin
    followed: float
    detour: float


Locks = Mapping[int, Lock]
"""Circle -> its lock."""


def commit(plan: NatPlan, locks: Locks, away: float, moving: Collection[int], settings: CommitmentSettings) -> Locks:
    """The locks after a plan; away [m] to the goal; moving: circles of what moves.

    A group takes over the lock that most of its circles have; one whose circles mostly move has none. A circle that is
    forgotten has none.
    """
    present = {circle.ident for circle in plan.circles}
    after = {ident: lock for ident, lock in locks.items() if ident in present and ident not in moving}
    for group in plan.groups:
        if 2 * sum(ident in moving for ident in group.idents) > len(group.idents):
            after = {ident: lock for ident, lock in after.items() if ident not in group.idents}
            continue
        lock = _lock_of(group, after)
        if lock is not None and _may_leave(group, lock, away, settings):
            after = {ident: lock for ident, lock in after.items() if ident not in group.idents}
        elif lock is not None and group.heeded and away > lock.followed + lock.detour:
            after.update(dict.fromkeys(group.idents, _other_side(lock)))
        elif lock is not None or (group.heeded and group.right < 0.0 < group.left):
            after.update(dict.fromkeys(group.idents, lock or Lock(group.spin, away, settings.detour)))
    return after


def were_reversed(before: Locks, after: Locks) -> bool:
    """Whether a side was given up because it led too far."""
    both = [(before[ident], lock) for ident, lock in after.items() if ident in before]
    return any(old.followed == new.followed and new.detour > old.detour for old, new in both)


def turned(group: Group, locks: Locks, away: float, settings: CommitmentSettings) -> Locks:
    """The locks after the robot has given up passing the group on this side."""
    lock = _lock_of(group, locks) or Lock(group.spin, away, settings.detour)
    return {**locks, **dict.fromkeys(group.idents, replace(lock, spin=opposite(group.spin)))}


def _other_side(lock: Lock) -> Lock:
    return Lock(opposite(lock.spin), lock.followed, 2.0 * lock.detour)


def inherit(spins: Memory, locks: Locks) -> Memory:
    """What the next plan inherits: a lock holds for good, and what was one and is left no longer does."""
    free = {ident: (spin, 0.0 if until == math.inf else until) for ident, (spin, until) in spins.items()}
    return {**free, **{ident: (lock.spin, math.inf) for ident, lock in locks.items()}}


def _lock_of(group: Group, locks: Locks) -> Lock | None:
    held = [locks[ident] for ident in group.idents if ident in locks]
    return max(held, key=lambda lock: (held.count(lock), -lock.followed, lock.spin), default=None)


def _may_leave(group: Group, lock: Lock, away: float, settings: CommitmentSettings) -> bool:
    """The direction of the goal is clear of the group, and nearer to the goal than where it was met."""
    return not group.right < 0.0 < group.left and away < lock.followed - settings.leave_by
