"""Traces under physics (PyBullet), open loop and closed loop."""
