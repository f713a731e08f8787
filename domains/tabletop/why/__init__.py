"""Why there is no plan: what is known before a search, and what can be said after one.

Before: objects that no hand can take, goals that contradict each other, and objects or goals that
no pose of the robot reaches even with no other object about. The estimate of the features names
candidates; X, asked many times, has the last word. After a search: what X confirms of where it
ended. Where other things are to blame, a smallest set of them is looked for without which there is
a plan (`blocking.py`).
"""
