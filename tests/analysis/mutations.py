"""All ways to alter one step of a certificate in one place."""

from __future__ import annotations

from collections.abc import Iterator
from copy import deepcopy
from typing import Any

from sketchlang.model import SketchModel


def mutations(proof: list[Any], model: SketchModel) -> Iterator[list[Any]]:
    """Proofs that differ from the given one in one step."""
    for path in list(_lists(proof, ())):
        steps = _at(proof, path)
        for i, step in enumerate(steps):
            yield _replaced(proof, (*path, slice(i, i + 1)), [])
            yield _replaced(proof, (*path, slice(i, i)), [step])
            if i:
                yield _replaced(proof, (*path, slice(i - 1, i + 1)), [step, steps[i - 1]])
            for altered in _altered(step, model):
                yield _replaced(proof, (*path, slice(i, i + 1)), [altered])


def _altered(step: dict[str, Any], model: SketchModel) -> Iterator[dict[str, Any]]:
    for key, value in step.items():
        rest = {k: v for k, v in step.items() if k != key}
        yield rest
        if key in ("lowers", "raises"):
            yield rest | {"raises" if key == "lowers" else "lowers": value}
            yield rest | {key: "no_such_feature"}
            for feature in model.features:
                if feature.name != value:
                    yield rest | {key: feature.name}
        elif key == "potential":
            for weights in _weights(value, model):
                yield rest | {key: weights}
        elif key == "rules":
            for names in _names(value, model):
                yield rest | {key: names}
        elif key == "split":
            for tree in _trees(value, model, len(step["blocks"])):
                yield rest | {key: tree}
        elif key == "blocks":
            for blocks in _blocks(value, model):
                yield rest | {key: blocks}


def _blocks(blocks: list[Any], model: SketchModel) -> Iterator[list[Any]]:
    yield blocks[::-1]
    yield [*blocks, {"rules": [], "proof": []}]
    for i, block in enumerate(blocks):
        yield blocks[:i] + blocks[i + 1 :]
        for names in _names(block["rules"], model):
            yield [*blocks[:i], block | {"rules": names}, *blocks[i + 1 :]]


def _weights(weights: dict[str, Any], model: SketchModel) -> Iterator[dict[str, Any]]:
    keys = [f.name for f in model.features] + [f"{f.name} > 0" for f in model.features]
    for key in [*keys, "no_such_feature"]:
        old = weights.get(key, 0)
        for weight in (old + 1, old - 1, -old, 2 * old, float(old), bool(old), str(old), None):
            if weight != old or type(weight) is not int:
                yield weights | {key: weight}
        yield {k: v for k, v in weights.items() if k != key}


def _names(names: list[str], model: SketchModel) -> Iterator[list[str]]:
    for i in range(len(names)):
        yield names[:i] + names[i + 1 :]
    for rule in model.rules:
        if rule.name not in names:
            yield [*names, rule.name]
            if names:
                yield [rule.name, *names[1:]]


def _trees(tree: Any, model: SketchModel, blocks: int) -> Iterator[Any]:
    if isinstance(tree, list):
        name, low, high = tree
        yield [name, high, low]
        yield low
        yield high
        for feature in model.features:
            if feature.name != name:
                yield [feature.name, low, high]
        for other in _trees(low, model, blocks):
            yield [name, other, high]
        for other in _trees(high, model, blocks):
            yield [name, low, other]
    else:
        for leaf in (None, *range(blocks + 1)):
            if leaf != tree:
                yield leaf


Path = tuple[Any, ...]


def _lists(steps: list[Any], path: Path) -> Iterator[Path]:
    yield path
    for i, step in enumerate(steps):
        for b, block in enumerate(step.get("blocks", ())):
            yield from _lists(block["proof"], (*path, i, "blocks", b, "proof"))


def _at(proof: Any, path: Path) -> Any:
    for key in path:
        proof = proof[key]
    return proof


def _replaced(proof: list[Any], path: Path, value: Any) -> list[Any]:
    copy = deepcopy(proof)
    _at(copy, path[:-1])[path[-1]] = value
    return copy
