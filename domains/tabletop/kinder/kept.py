"""Records of problems in a file, one JSON object a line, as `--json` prints them.

The file is written anew with every record and takes the place of the one before in one step, so
that a run that is killed loses the problem that it was at and no more.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

from domains.tabletop.kinder.run import Record
from sketchlang.errors import InputError
from sketchlang.files import write_text
from sketchlang.reading import read_text

TYPES: dict[str, tuple[type, ...]] = {
    "str": (str,),
    "int": (int,),
    "bool": (bool,),
    "float": (int, float),
    "str | None": (str, type(None)),
}
"""What JSON has for each annotation of a record."""


def records_in(path: Path) -> list[Record]:
    """The records of a file; none where there is no file.

    Raises:
        InputError: it cannot be read, or a line is no record, or a second one of a problem.
    """
    if not path.exists():
        return []
    found: dict[tuple[str, int], Record] = {}
    for number, line in enumerate(read_text(path).splitlines(), 1):
        record = _record(line)
        if record is None or (record.env, record.seed) in found:
            word = "is no record of a problem" if record is None else "is a second one of a problem"
            raise InputError(word, place=f"{path}: line {number}")
        found[record.env, record.seed] = record
    return list(found.values())


def write_records(path: Path, records: Sequence[Record]) -> None:
    """Put records into a file.

    Raises:
        InputError: it cannot be written.
    """
    lines = "".join(f"{json.dumps(record.as_json())}\n" for record in records)
    write_text(path, lines, over_input=True)  # it is the file that was read, and more


def _record(line: str) -> Record | None:
    try:
        told: Any = json.loads(line)
    except ValueError:
        return None
    wanted = {field.name: str(field.type) for field in fields(Record)}
    if not isinstance(told, dict) or told.keys() != wanted.keys():
        return None
    if any(_is_other(value, wanted[name]) for name, value in told.items()):
        return None
    return Record(**told)


def _is_other(value: Any, kind: str) -> bool:
    """Whether a value is of another type than an annotation says; a bool is no number."""
    if isinstance(value, bool) or not isinstance(value, TYPES[kind]):
        return kind != "bool" or not isinstance(value, bool)
    return isinstance(value, float) and not math.isfinite(value)
