"""Features of PDDL states as operations on bits: the quick way of `sketchlang.compile`."""
