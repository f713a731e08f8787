"""One spelling for every sign, whichever the author prefers."""

SIGNS = {
    "≠": "!=",
    "≤": "<=",
    "≥": ">=",
    "∈": "in",
    "↓": "--",
    "↑": "++",
    "∃": "some",
    "∀": "all",
}
"""The paper's signs for operators that the syntax tree names by the other spelling."""
