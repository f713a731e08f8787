"""Problems of the public benchmark for task and motion planning (Lagriffoul et al. 2018).

`problem` reads the XML of a problem (things with their meshes and poses, and where one can put
something on them), `wanted` the goal from its PDDL, `scene` writes both as a scene file.
"""
