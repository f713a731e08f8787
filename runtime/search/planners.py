"""The planners by the names that the command line uses."""

from __future__ import annotations

from runtime.search.siw_r import eager, lazy, lazy_siiw_r, siw_r

PLANNERS = {"lazy-siiw-r": lazy_siiw_r, "siw-r": siw_r}
SEARCHES = {"lazy-siiw-r": lazy, "siw-r": eager}
"""How each of them looks for one subgoal."""

ABOUT = {
    "lazy-siiw-r": "one IW search a subgoal; motions are planned for promising subplans only",
    "siw-r": "one IW search a subgoal; every action is tried by motion planning at once",
}
"""What each of them does, in one line."""

DEFAULT = "lazy-siiw-r"
