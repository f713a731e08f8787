"""Runs in an environment that has pymimir, and nothing of this project: how quick mimir searches.

    python mimir_peer.py DOMAIN TASK SECONDS

writes one line of JSON for breadth-first search and one for IW(1), both without features, on the
task that mimir grounded: `{"search": NAME, "expanded": N, "generated": N, "seconds": S}`. The
seconds are processor time of the search alone; breadth-first search ends after `SECONDS`.
"""

from __future__ import annotations

import json
import os
import sys
import time


def measured(domain: str, task: str, seconds: float) -> list[dict[str, object]]:
    """The two searches, one after the other."""
    from pymimir.advanced import search

    grounded = search.SearchContextOptions(search.GroundedOptions())
    context = search.SearchContext.create(domain, task, grounded)
    problem = context.get_problem()
    found: list[dict[str, object]] = []

    def told(name: str, begun: float, statistics: list[object]) -> None:
        found.append(
            {
                "search": name,
                "expanded": sum(each.get_num_expanded() for each in statistics),  # type: ignore[attr-defined]
                "generated": sum(each.get_num_generated() for each in statistics),  # type: ignore[attr-defined]
                "seconds": time.process_time() - begun,
            }
        )

    handler = search.DefaultBrFSEventHandler(problem, True)
    breadth = search.BrFSOptions()
    breadth.event_handler = handler
    breadth.max_time_in_ms = round(1000 * seconds)
    begun = time.process_time()
    search.find_solution_brfs(context, breadth)
    told("breadth-first", begun, [handler.get_statistics()])
    novelty = search.IWOptions()
    novelty.max_arity = 1
    novelty.brfs_event_handler = search.DefaultBrFSEventHandler(problem, True)
    novelty.iw_event_handler = search.DefaultIWEventHandler(problem, True)
    begun = time.process_time()
    search.find_solution_iw(context, novelty)
    by_arity = novelty.iw_event_handler.get_statistics().get_brfs_statistics_by_arity()
    told("IW(1)", begun, list(by_arity))
    return found


if __name__ == "__main__":
    # The library writes progress of its own to standard output: the answer has that to itself.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    for each in measured(sys.argv[1], sys.argv[2], float(sys.argv[3])):
        print(json.dumps(each), file=answers)
