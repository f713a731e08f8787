"""An independent judge of plans: exact geometry (FCL), its own kinematics, no planner code.

It shares with the planner the readers of files and the description of the robot, and nothing
that decides whether something collides.
"""
