"""Scenes: tables, walls, objects, goals and where the robot starts, from TOML files."""
