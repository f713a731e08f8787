"""Motion planning: arm paths by RRT-Connect (OMPL), base paths along a visibility graph."""
