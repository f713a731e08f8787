"""Proposes a robot file for a URDF: each file finds one thing that the URDF does not say."""
