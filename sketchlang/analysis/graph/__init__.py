"""Pictures of sketches: what to draw, where to put it, and the formats it is written in."""
