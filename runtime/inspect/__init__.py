"""Looking inside a task: walks of a planner, states seen through a sketch, what comes along."""
