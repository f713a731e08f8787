"""Benchmarks: scenes x planners x seeds in parallel processes, stored line by line."""
