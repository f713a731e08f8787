"""A: the ground actions of a subproblem, sampled at its start (paper, Ground Actions).

Relevant objects and surfaces come first, grasps from the side that nothing bars first, and
base poses where the sampled grasps can be taken. Each failure of a subproblem doubles the
density and drops a restriction; from the fourth attempt on every grasp, placement and base
pose can be sampled, which keeps the planner probabilistically complete.
"""
