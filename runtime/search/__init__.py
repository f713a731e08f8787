"""Width-based search guided by sketches. One algorithm a file; nothing here knows geometry."""
