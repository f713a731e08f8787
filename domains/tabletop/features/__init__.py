"""What the features compute: obstructions, disturbances, goals and words."""
