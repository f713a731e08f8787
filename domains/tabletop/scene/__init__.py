"""Scene files: their model, their reader, a generator."""
