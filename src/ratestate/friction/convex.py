"""The convex function in which motion without inertia is written (quasi_static.py), inverted."""

import numpy as np


def convex(z):
    """exp(-z) - 1 + z: convex, >= 0, z^2/2 near 0."""
    return np.expm1(-z) + z


def inverse_convex(value, sign):
    """The z of this sign with convex(z) = value > 0."""
    far = value + np.sqrt(2 * value)
    z = np.where(sign > 0, far, -np.log1p(far))  # beyond the root, where it is convex
    for _ in range(40):
        step = (convex(z) - value) / -np.expm1(-z)
        z = z - step
        if np.all(np.abs(step) <= 1e-15 * np.abs(z)):
            break
    return z
