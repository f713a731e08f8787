"""Accessibility of a replay page, by axe-core in a headless Chromium."""
