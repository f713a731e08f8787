"""How the checker of certificates reads JSON: strictly, and everything else is refused."""

from __future__ import annotations

import json
from typing import Any, NoReturn


class RefusedError(Exception):
    """The certificate does not prove that this sketch terminates; the message says why."""


def refuse(reason: str) -> NoReturn:
    raise RefusedError(reason)


def read_certificate(data: bytes) -> Any:
    """The JSON value of a file.

    Raises:
        RefusedError: it is no JSON, a key is twice in an object, or a number is no integer.
    """
    try:
        return json.loads(
            data.decode("utf-8"),
            object_pairs_hook=_no_key_twice,
            parse_float=_no_number,
            parse_constant=_no_number,
        )
    except UnicodeDecodeError:
        refuse("it is not a text in UTF-8")
    except json.JSONDecodeError as error:
        refuse(f"it is not JSON, see line {error.lineno}, column {error.colno}: {error.msg}")
    except RecursionError:
        refuse("it is nested too deeply")
    except ValueError:
        # Python reads no number of more than 4300 digits.
        refuse("it contains a number that is too long")


def an_object(value: Any, where: str, keys: str) -> dict[str, Any]:
    """The value, if it is an object with exactly these keys (separated by blanks)."""
    if type(value) is not dict or set(value) != set(keys.split()):
        refuse(f"{where}: an object with the keys {', '.join(keys.split())} is expected")
    return value


def an_integer(value: Any, where: str) -> int:
    """The value, if it is an integer: true and 1.0 are none."""
    if type(value) is not int:
        refuse(f"{where}: {value!r} is not an integer")
    return value


def a_text(value: Any, where: str) -> str:
    """The value, if it is a string."""
    if type(value) is not str:
        refuse(f"{where}: {value!r} is not a text")
    return value


def _no_key_twice(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    value = dict(pairs)
    if len(value) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        refuse(f"the key {twice!r} is twice in one object")
    return value


def _no_number(text: str) -> NoReturn:
    refuse(f"{text[:20]} is not an integer")
