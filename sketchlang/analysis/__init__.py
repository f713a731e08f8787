"""Analyses over `SketchModel`: termination with evidence, coverage, graphs."""
