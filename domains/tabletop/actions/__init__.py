"""Actions: from a ground action to a motion, and how each is told and written."""
