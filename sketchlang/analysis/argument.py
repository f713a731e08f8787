"""A proof of termination in words, in the manner of the paper (Sketch termination)."""

from __future__ import annotations

from collections.abc import Sequence

from sketchlang.analysis.bits import rule_bits
from sketchlang.analysis.proof import Drop, Node, Potential, Ranks, Split, Step, Term, Tree
from sketchlang.analysis.words import counted, cube, listed, literal, rule_names
from sketchlang.model import Kind, SketchModel

MOST_BLOCKS = 8
"""Blocks of one split that are written out."""

MOST_NAMED = 5
"""Rules that are named one by one where a number would do."""

MOST_TERMS = 12
"""Terms of a weighted sum that are written out; the certificate has them all."""

MOST_CUBES = 4
"""Groups of valuations by which one block is described."""


def argument(model: SketchModel, steps: Sequence[Step]) -> list[str]:
    """Lines that say which rules fall away, in which order, because of which feature."""
    writer = _Writer(model)
    alive = [rule.index for rule in rule_bits(model) if not rule.dead]
    lines = [
        f"{name} never fires: its effects contradict its conditions."
        for name in rule_names(model, (r for r in range(len(model.rules)) if r not in alive))
    ]
    lines += writer.steps(steps, alive, "")
    if not model.rules:
        lines.append("There are no rules, so there is nothing to follow.")
    else:
        lines.append("No rule is left, so no run goes on for ever.")
    return lines


class _Writer:
    def __init__(self, model: SketchModel) -> None:
        self.model = model

    def steps(self, steps: Sequence[Step], rules: Sequence[int], indent: str) -> list[str]:
        lines: list[str] = []
        left = list(rules)
        for number, step in enumerate(steps, start=1):
            mark = f"{indent}{number}. "
            inner = " " * len(mark)
            if isinstance(step, Drop):
                gone = set(step.rules)
                others = [rule for rule in left if rule not in gone]
                lines.append(mark + self.drop(step, others))
            elif isinstance(step, Potential):
                gone = set(step.rules)
                others = [rule for rule in left if rule not in gone]
                lines.append(mark + self.potential(step, others))
            elif isinstance(step, Ranks):
                gone = set(step.rules)
                lines.append(mark + self.ranks(step))
            else:
                gone = set(step.drops)
                first, *rest = self.split(step, left, inner)
                lines += [mark + first, *rest]
            left = [rule for rule in left if rule not in gone]
        return lines

    def drop(self, step: Drop, others: Sequence[int]) -> str:
        names = rule_names(self.model, step.rules)
        feature = self.model.features[step.feature].name
        subject, verb, does = _subject(names)
        change, back = ("raise", "lowers") if step.upwards else ("lower", "raises")
        change = f"{change}s" if len(names) == 1 else change
        if not others:
            against = "no other rule can still fire"
        elif len(others) <= MOST_NAMED:
            left = listed(rule_names(self.model, others))
            against = f"nothing else that can still fire ({left}) {back} it"
        else:
            against = f"none of the {len(others)} other rules that can still fire {back} it"
        bound = f"; {feature} is declared bounded" if step.upwards else ""
        return (
            f"{subject} {verb} only finitely often: "
            f"{does} {change} {feature}, and {against}{bound}."
        )

    def potential(self, step: Potential, others: Sequence[int]) -> str:
        names = rule_names(self.model, step.rules)
        weighed = weighted_sum(self.model, step.terms)
        if not others:
            every = "every rule" if len(names) > 1 else names[0]
            return f"{weighed} falls with {every}, and it cannot fall for ever."
        if len(others) <= MOST_NAMED:
            left = listed(rule_names(self.model, others), "or")
            falls = f"every rule but {left}" if len(others) < len(names) else listed(names)
            return f"{weighed} falls with {falls}, and does not rise with {left}."
        falls = listed(names) if len(names) <= MOST_NAMED else f"{len(names)} rules"
        return f"{weighed} falls with {falls}, and none of the {len(others)} others raises it."

    def ranks(self, step: Ranks) -> str:
        names = rule_names(self.model, step.rules)
        subject = listed(names) if len(names) <= MOST_NAMED else f"the {len(names)} rules left"
        count = (
            f"{1 << len(step.features):,} valuations of {counted(len(step.features), 'feature')}"
        )
        if len(step.tables) == 1:
            return f"All {count} can be put in an order in which none of {subject} leads back."
        return (
            f"All {count} can be put in an order in which none of {subject} leads back, but for "
            "rules that lower a nat which nothing raises among valuations that reach each other; "
            f"without these the same is true of what is left, {len(step.tables)} times over."
        )

    def split(self, step: Split, rules: Sequence[int], indent: str) -> list[str]:
        plain = self._plain_flip(step)
        if plain:
            return [plain]
        features = listed([self.model.features[f].name for f in sorted(_asked(step.tree))])
        names = rule_names(self.model, rules)
        left = listed(names) if len(names) <= MOST_NAMED else f"the {len(names)} rules left"
        lines = [
            f"Now to {left}, by the truth of {features}. None of them leads from a group below "
            "back to an earlier one, so in the long run a run stays in one group:"
        ]
        groups = _groups(step)
        shown = [(n, block) for n, block in enumerate(step.blocks) if block.rules][:MOST_BLOCKS]
        for number, block in shown:
            where = self._where(groups[number])
            lines.append(f"{indent}{where}: {self._staying(block.rules, rules)}.")
            lines += self.steps(block.steps, block.rules, indent + "  ")
        idle = sum(not block.rules for block in step.blocks)
        hidden = len(step.blocks) - idle - len(shown)
        if hidden:
            lines.append(
                f"{indent}... and {counted(hidden, 'more group')}; the certificate has them all."
            )
        if idle and shown:
            lines.append(f"{indent}Elsewhere none of them can fire twice.")
        elif idle == 1:
            lines.append(f"{indent}In no valuation can a run go on with any of them.")
        elif idle:
            count = "two" if idle == 2 else str(idle)
            lines.append(f"{indent}All {count} groups are passed at most once, one after another.")
        if step.drops:
            subject, verb, _ = _subject(rule_names(self.model, step.drops))
            lines.append(f"{indent}So {subject} {verb} only finitely often.")
        return lines

    def _plain_flip(self, step: Split) -> str | None:
        """One feature, changed one way only: that deserves a plain sentence."""
        tree = step.tree
        if not isinstance(tree, Node) or any(block.rules and block.steps for block in step.blocks):
            return None
        if not isinstance(tree.low, int) or not isinstance(tree.high, int):
            return None
        later = tree.high > tree.low
        subject, verb, does = _subject(rule_names(self.model, step.drops))
        makes = "makes" if len(step.drops) == 1 else "make"
        target = literal(self.model, tree.feature, later)
        source = literal(self.model, tree.feature, not later)
        return (
            f"{subject} {verb} at most once: {does} {makes} {target} where {source} was true, "
            f"and nothing that can still fire makes {source} true again."
        )

    def _staying(self, inside: Sequence[int], rules: Sequence[int]) -> str:
        names = rule_names(self.model, inside)
        absent = rule_names(self.model, [rule for rule in rules if rule not in inside])
        can = f"{listed(names)} can go on there"
        return f"{can}, {listed(absent, 'or')} cannot" if 0 < len(absent) <= MOST_NAMED else can

    def _where(self, cubes: Sequence[tuple[int, int]]) -> str:
        shown = [cube(self.model, known, bits) for known, bits in cubes[:MOST_CUBES]]
        more = len(cubes) - len(shown)
        return " or ".join(shown) + (f" or {more} more" if more else "")


def weighted_sum(model: SketchModel, terms: Sequence[Term]) -> str:
    """`2 m + H - 3 (n > 0)`, long sums shortened. A Boolean counts as 1 where it is true."""
    text = ""
    for term in terms[:MOST_TERMS]:
        declared = model.features[term.feature]
        name = declared.name
        if term.of_truth and declared.kind is Kind.NAT:
            name = f"({name} > 0)"
        factor = "" if abs(term.weight) == 1 else f"{abs(term.weight)} "
        sign = ("- " if term.weight < 0 else "+ ") if text else ("-" if term.weight < 0 else "")
        text += f"{' ' if text else ''}{sign}{factor}{name}"
    more = len(terms) - MOST_TERMS
    return f"{text} + ({more} more terms)" if more > 0 else text


def _subject(names: Sequence[str]) -> tuple[str, str, str]:
    """Names of rules as a subject, its verb, and a pronoun for it."""
    return (listed(names), "fires", "it") if len(names) == 1 else (listed(names), "fire", "they")


def _asked(tree: Tree) -> set[int]:
    if not isinstance(tree, Node):
        return set()
    return {tree.feature} | _asked(tree.low) | _asked(tree.high)


def _groups(step: Split) -> list[list[tuple[int, int]]]:
    """For each block the cubes (features known, bits) that the tree sends there."""
    groups: list[list[tuple[int, int]]] = [[] for _ in step.blocks]

    def visit(tree: Tree, known: int, bits: int) -> None:
        if isinstance(tree, Node):
            bit = 1 << tree.feature
            visit(tree.low, known | bit, bits)
            visit(tree.high, known | bit, bits | bit)
        elif tree is not None:
            groups[tree].append((known, bits))

    visit(step.tree, 0, 0)
    return groups
