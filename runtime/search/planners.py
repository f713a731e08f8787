"""The planners by the names that the command line uses."""

from __future__ import annotations

from runtime.search.retreat import Planner, lazy_siiw_r, siw_r
from runtime.search.siw_r import eager, lazy
from runtime.search.whole import bfws_whole, brfs_whole, iw_whole

PLANNERS: dict[str, Planner] = {
    "lazy-siiw-r": lazy_siiw_r,
    "siw-r": siw_r,
    "bfws": bfws_whole,
    "iw": iw_whole,
    "brfs": brfs_whole,
}
SEARCHES = {"lazy-siiw-r": lazy, "siw-r": eager}
"""How those look for one subgoal that go from subgoal to subgoal."""

ABOUT = {
    "lazy-siiw-r": "one IW search a subgoal; motions are planned for promising subplans only",
    "siw-r": "one IW search a subgoal; every action is tried by motion planning at once",
    "bfws": "no rules, to compare with: best-first width search by open goals and obstructions",
    "iw": "no rules, to compare with: IW(1), IW(2), ... for the goal",
    "brfs": "no rules, to compare with: breadth-first search for the goal",
}
"""What each of them does, in one line."""

DEFAULT = "lazy-siiw-r"
