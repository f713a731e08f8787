"""Closed loop: sense, plan one subgoal, carry it out, and again."""
