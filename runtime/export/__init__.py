"""Traces in the formats of others: ROS 2 messages and bags, GLB."""
