"""A step of Rodas5P as in the books, with the engine's coefficients as full matrices."""

import numpy as np

from ratestate.engine import rodas5p as R

# Stage i starts from y + sum_j A_ij k_j.
A, C = np.zeros((9, 8)), np.zeros((8, 8))
for i, row in enumerate(R.A):
    A[i, : len(row)] = row
for i, row in enumerate(R.C):
    C[i, : len(row)] = row


def published_step(f, jacobian, f_t, y, h):
    """Take a step on dy/dt = f(t, y), real or complex: y_new, error, K_1 to K_3."""
    solve = np.linalg.inv(np.eye(len(y)) / (R.GAMMA * h) - jacobian)
    k = np.zeros((8, len(y)), np.result_type(y))
    for i in range(8):
        value = f(R.NODES[i] * h, y + A[i] @ k)
        k[i] = solve @ (value + C[i] @ k / h + h * R.D[i] * f_t)
    return y + A[8] @ k, k[7], np.array(R.H) @ k
