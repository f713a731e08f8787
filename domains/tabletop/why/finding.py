"""Findings about an object, as data and in a sentence."""

from __future__ import annotations

from typing import Any

Finding = dict[str, Any]


def finding(name: str, cause: str, text: str, certain: bool = True, **more: Any) -> Finding:
    """What is wrong with an object. `certain`: no search would change it, as far as X was asked."""
    return {"object": name, "cause": cause, "text": text, "certain": certain, **more}
