"""Traces: what a robot did or is to do, complete in one file (`docs/trace-format.md`).

Replays, execution, pictures and exports read traces and nothing else.
"""
