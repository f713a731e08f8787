"""The version, apart from everything else: whoever writes it into a file imports nothing more."""

__version__ = "0.1.0"
