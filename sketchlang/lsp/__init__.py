"""What editors ask of a sketch. Only `server` knows the protocol; the rest are plain functions."""
