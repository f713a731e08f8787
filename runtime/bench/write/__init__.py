"""Tables and results as text, one file a format."""
