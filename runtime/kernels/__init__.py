"""The few hot loops, compiled.

Each kernel has a plain reference twin in `tests/runtime/reference.py`.
Poses are 3x4 matrices `[R | t]`; lengths are metres, angles radians.

Numba compiles them, once; from then on their machine code is loaded without it
(`runtime.kernels.compiled`).
"""
