"""The planners by the names that the command line uses."""

from __future__ import annotations

from runtime.search.siw_r import siw_r

PLANNERS = {"siw-r": siw_r}
DEFAULT = "siw-r"
