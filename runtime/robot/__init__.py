"""Robots are data: a URDF and a small TOML file. Nothing here knows a robot's name."""
