"""The few hot loops, compiled by numba.

Each kernel has a plain reference twin in `tests/kernels`, against which it is compared.
Poses are 3x4 matrices `[R | t]`; lengths are metres, angles radians.
"""
