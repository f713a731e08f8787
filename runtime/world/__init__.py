"""Solids, bodies, poses and supports: the geometry of a world that a robot moves things in."""
