"""States of PDDL tasks."""

from __future__ import annotations

from domains.pddl.features.rows import bits_of
from domains.pddl.ground.task import GroundTask


class State:
    """A state: the atoms that are true, as bits. States of one task only are compared."""

    __slots__ = ("bits", "task")

    def __init__(self, bits: int, task: GroundTask) -> None:
        self.bits = bits
        self.task = task

    def __eq__(self, other: object) -> bool:
        return isinstance(other, State) and self.bits == other.bits and self.task is other.task

    def __hash__(self) -> int:
        return hash(self.bits)

    def __repr__(self) -> str:
        return " ".join(atom_texts(self))


def atom_texts(state: State) -> list[str]:
    """The atoms that change and are true, as PDDL writes them."""
    boxes = sorted(state.task.layout.boxes.values(), key=lambda box: box.offset)
    found = []
    number = 0
    for bit in bits_of(state.bits):
        while bit >= boxes[number].offset + boxes[number].size:
            number += 1
        box = boxes[number]
        terms = [state.task.objects[value] for value in box.values(bit)]
        found.append(f"({' '.join((box.predicate, *terms))})")
    return found
