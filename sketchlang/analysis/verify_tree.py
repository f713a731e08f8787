"""Decision trees over features, as the checker of certificates walks them."""

from __future__ import annotations

from dataclasses import dataclass

from sketchlang.model import And, Formula, Literal, Not, Or


@dataclass(frozen=True, eq=False, slots=True)
class Question:
    """A node of a decision tree; equal nodes of a tree are one object."""

    feature: int
    low: Answer
    high: Answer


Answer = int | None | Question


def follow(nodes: tuple[Answer, ...], feature: int, bit: bool) -> tuple[Answer, ...]:
    """The nodes after the answer to one feature; those that ask for another stay."""
    return tuple(
        (node.high if bit else node.low)
        if isinstance(node, Question) and node.feature == feature
        else node
        for node in nodes
    )


def truth(formula: Formula, answers: dict[int, bool]) -> bool | None:
    """Truth of a formula when only some features are known; None if it depends."""
    match formula:
        case Literal(feature, positive):
            return answers[feature] == positive if feature in answers else None
        case Not(operand):
            value = truth(operand, answers)
            return None if value is None else not value
        case And(operands) | Or(operands):
            decides = isinstance(formula, Or)
            values = [truth(operand, answers) for operand in operands]
            return decides if decides in values else None if None in values else not decides


def subtree_key(answer: Answer) -> int:
    """Identifies a subtree: leaves by value, questions by object (they are kept alive)."""
    return id(answer) if isinstance(answer, Question) else -2 if answer is None else -3 - answer
