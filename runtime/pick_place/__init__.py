"""The pick-and-place domain: the tuple T = (S, s0, G, Act, A, X, N) of the paper."""
