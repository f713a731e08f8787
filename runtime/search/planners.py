"""The planners by the names that the command line uses."""

from __future__ import annotations

from runtime.search.siw_r import lazy_siiw_r, siw_r

PLANNERS = {"lazy-siiw-r": lazy_siiw_r, "siw-r": siw_r}
DEFAULT = "lazy-siiw-r"
