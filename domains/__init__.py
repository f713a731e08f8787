"""Domains and their sketches, one folder each; `pick_and_place.sketch` serves several."""
