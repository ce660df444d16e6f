"""Conditions with memory as registers and guards (L9).

Takes: resolved conditions. Gives: `Registers`: for each distinct text its value in this tick as a guard, and what its
registers hold in the next. Leaves alone: what percepts are.

Each form costs a fixed number of registers, whatever the past. Spans of ticks are counted in binary, so that `held-for`
of n ticks takes about log2(n) registers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from rplan.goals.condition import Condition, Memory
from rplan.ways.guards import FALSE, TRUE, Guards

Counter = list[tuple[int, int]]
"""Bits of a number, the lowest first: the register, and the guard that reads it."""


@dataclass(frozen=True, slots=True)
class Register:
    """One bit: its first value, and the guard of its value in the next tick."""

    name: str
    initial: bool
    next: int


@dataclass(slots=True)
class Registers:
    """The registers of a plan, by the text of the condition that they serve."""

    guards: Guards
    guard_of: Callable[[Condition], int]
    values: dict[str, int] = field(default_factory=dict)
    names: list[str] = field(default_factory=list)
    initial: list[bool] = field(default_factory=list)
    next: dict[int, int] = field(default_factory=dict)
    waiting: list[tuple[int, Condition]] = field(default_factory=list)

    def value(self, memory: Memory) -> int:
        """The guard of a condition with memory in this tick."""
        if memory.text not in self.values:
            self.values[memory.text] = self._build(memory)
        return self.values[memory.text]

    def finished(self) -> tuple[Register, ...]:
        """All registers, once every condition has been asked; a delayed condition may ask for more of them."""
        while self.waiting:
            number, condition = self.waiting.pop(0)
            self.next[number] = self.guard_of(condition)
        return tuple(
            Register(name, initial, self.next[number])
            for number, (name, initial) in enumerate(zip(self.names, self.initial, strict=True))
        )

    def _new(self, name: str, initial: bool) -> tuple[int, int]:
        """A new register: its number, and the guard that reads it."""
        number = len(self.names)
        self.names.append(name)
        self.initial.append(initial)
        return number, self.guards.register(number)

    def _build(self, memory: Memory) -> int:
        match memory.form:
            case "delay":
                number, before = self._new(memory.text, memory.initial)
                self.waiting.append((number, memory.conditions[0]))
                return before
            case "held-for":
                return self._held_for(memory.text, self._part(memory, 0), memory.ticks - 1)
            case "within":
                return self._within(memory.text, self._part(memory, 0), memory.ticks - 1)
            case "at-least":
                return self._at_least(memory.text, self._part(memory, 0), self._part(memory, 1), memory.ticks)
            case "rose" | "fell":
                return self._edge(memory)
            case _:
                return self._since(memory)

    def _part(self, memory: Memory, number: int) -> int:
        return self.guard_of(memory.conditions[number]) if number < len(memory.conditions) else FALSE

    def _edge(self, memory: Memory) -> int:
        """The register starts so that the first tick has no edge."""
        now = self._part(memory, 0)
        number, before = self._new(memory.text, memory.form == "rose")
        self.next[number] = now
        return self.guards.but_not(now, before) if memory.form == "rose" else self.guards.but_not(before, now)

    def _since(self, memory: Memory) -> int:
        """What holds from some tick on: the register has its value of the tick before."""
        g = self.guards
        now, other = self._part(memory, 0), self._part(memory, 1)
        number, before = self._new(memory.text, memory.form == "historically")
        match memory.form:
            case "once":
                value = g.either(now, before)
            case "historically":
                value = g.both(now, before)
            case "since":
                value = g.either(other, g.both(now, before))
            case _:
                value = g.but_not(g.either(now, before), other)
        self.next[number] = value
        return value

    # --- spans of ticks ---

    def _held_for(self, text: str, now: int, before: int) -> int:
        """Counts the ticks before this one in which it held in a row, up to `before`."""
        counter = self._counter(text, before)
        full = self._equals([bit for _, bit in counter], before)
        for (number, bit), up in zip(counter, self._plus_one(counter), strict=True):
            self.next[number] = self.guards.both(now, self._choose(full, bit, up))
        return self.guards.both(now, full)

    def _within(self, text: str, now: int, after: int) -> int:
        """Counts down the ticks for which it is still remembered."""
        counter = self._counter(text, after)
        some = self.guards.any_of(bit for _, bit in counter)
        for place, ((number, _), down) in enumerate(zip(counter, self._minus_one(counter), strict=True)):
            start = TRUE if after >> place & 1 else FALSE
            self.next[number] = self._choose(now, start, self.guards.both(some, down))
        return self.guards.either(now, some)

    def _at_least(self, text: str, now: int, reset: int, count: int) -> int:
        """Counts the ticks in which it held since the reset, up to `count`."""
        counter = self._counter(text, count)
        step = self.guards.but_not(now, self._equals([bit for _, bit in counter], count))
        after = [
            self.guards.but_not(self._choose(step, up, bit), reset)
            for (_, bit), up in zip(counter, self._plus_one(counter), strict=True)
        ]
        for (number, _), value in zip(counter, after, strict=True):
            self.next[number] = value
        return self._equals(after, count)

    def _counter(self, text: str, most: int) -> Counter:
        """Registers for a number up to `most`, at first 0."""
        return [self._new(f"{text}#{place}", False) for place in range(most.bit_length())]

    def _equals(self, bits: list[int], number: int) -> int:
        return self.guards.all_of(
            bit if number >> place & 1 else self.guards.negation(bit) for place, bit in enumerate(bits)
        )

    def _plus_one(self, counter: Counter) -> list[int]:
        carry, out = TRUE, []
        for _, bit in counter:
            out.append(self._different(bit, carry))
            carry = self.guards.both(bit, carry)
        return out

    def _minus_one(self, counter: Counter) -> list[int]:
        borrow, out = TRUE, []
        for _, bit in counter:
            out.append(self._different(bit, borrow))
            borrow = self.guards.but_not(borrow, bit)
        return out

    def _different(self, a: int, b: int) -> int:
        return self.guards.either(self.guards.but_not(a, b), self.guards.but_not(b, a))

    def _choose(self, condition: int, a: int, b: int) -> int:
        return self.guards.either(self.guards.both(condition, a), self.guards.but_not(b, condition))
