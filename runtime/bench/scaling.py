"""The suite of generated scenes that grow."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path

from runtime.bench.suite import Block, Suite
from sketchlang.errors import InputError
from sketchlang.files import write_text
from sketchlang.reading import read_text

SIZES = (10, 28, 56, 112, 200)
SEEDS = 3


def scaling_suite(
    folder: Path, sorting: Callable[[int, int], str], sizes: Sequence[int] = SIZES
) -> Suite:
    """The suite, its scenes written to a folder so that they can be looked at; `sorting` gives
    the text of a scene with so many objects, by a seed.

    Raises:
        InputError: a scene cannot be written, or something else is there.
    """
    names = []
    for size in sizes:
        path = folder / f"sorting-{size}.toml"
        text = sorting(size, size)
        if not os.path.lexists(path):
            write_text(path, text)
        elif read_text(path) != text:
            raise InputError("is here already and not the scene of this suite", place=str(path))
        names.append(path.name)
    block = Block(("pick_and_place",), tuple(names), ("lazy-siiw-r",), tuple(range(SEEDS)))
    return Suite("scaling", (block,), str(folder), "scaling")
