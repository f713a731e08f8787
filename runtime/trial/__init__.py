"""Sketches tested against their domain: states of small scenes, and what is wrong in them."""
