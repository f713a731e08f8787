"""Plans that take less time: a local search over runs of the sketch."""
