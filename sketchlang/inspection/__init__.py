"""Looking inside: why a feature has its value in a state, and which rules apply there."""
