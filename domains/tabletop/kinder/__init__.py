"""Problems of KinDER (PyPI `kindergarden`) as scenes, and plans played back in it.

KinDER lives in an environment of its own (`make kinder`): `child.py` runs there and is spoken to
over pipes, so that neither side imports the other. Its `terminated` flag judges, nothing here.
"""
