"""Everything that runs: search, robots, collision checking, motion planning, plans."""
