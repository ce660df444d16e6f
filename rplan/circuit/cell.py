"""The cells of a circuit, and the one meaning of each operation.

Takes: nothing. Gives: `Op` with `meaning`, `Cell`. Leaves alone: wiring; see circuit.py.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Op(Enum):
    """What a cell does. constant, input and register have no operands."""

    CONSTANT = "constant"
    INPUT = "input"
    REGISTER = "register"
    NOT = "not"
    AND = "and"
    OR = "or"

    __hash__ = object.__hash__
    """By identity, as they compare; circuits look operations up by the hundred thousand."""

    @property
    def arity(self) -> int:
        """How many nets it reads."""
        match self:
            case Op.CONSTANT | Op.INPUT | Op.REGISTER:
                return 0
            case Op.NOT:
                return 1
            case Op.AND | Op.OR:
                return 2

    def meaning(self, operands: tuple[bool, ...]) -> bool:
        """The value of a gate from those of its operands: every engine must agree with this."""
        match self:
            case Op.NOT:
                return not operands[0]
            case Op.AND:
                return operands[0] and operands[1]
            case Op.OR:
                return operands[0] or operands[1]
            case Op.CONSTANT | Op.INPUT | Op.REGISTER:
                raise ValueError(f"{self.value} is not a gate")


@dataclass(frozen=True, slots=True)
class Cell:
    """One cell; it drives the net of its own number.

    operands: nets with smaller numbers. index: which input or register it is, or the value of a constant.
    """

    op: Op
    operands: tuple[int, ...] = ()
    index: int = 0
