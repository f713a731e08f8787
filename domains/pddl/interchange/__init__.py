"""Sketches in the notations of other tools, translated into the language."""
