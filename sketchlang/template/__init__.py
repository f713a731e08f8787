"""The files that `sketchlang new domain` writes, with NAME in the place of the name."""
