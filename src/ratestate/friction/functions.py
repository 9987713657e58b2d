"""Functions that forms of friction are written with, of numbers and of arrays.

The engine has versions of its own (engine/functions.py), which loops over lanes can vectorise.
"""


def softplus(x):
    """ln(1 + e**x)."""
    import numpy as np  # slow to import, and `ratestate --help` needs the names of laws alone

    size = np.where(np.real(x) < 0.0, -x, x)
    return np.where(np.real(x) < 0.0, 0.0, x) + np.log1p(np.exp(-size))


def logistic(x):
    """1/(1 + e**-x), the derivative of `softplus`."""
    import numpy as np

    small = np.exp(np.where(np.real(x) < 0.0, x, -x))
    return np.where(np.real(x) < 0.0, small, 1.0) / (1.0 + small)


# Of tuples with a number a state


def softplus_each(x, y):
    """`softplus` of x + y_k."""
    return tuple(softplus(x + one) for one in y)


def logistic_each(x, y):
    """`logistic` of x + y_k."""
    return tuple(logistic(x + one) for one in y)


def bent_each(y):
    """y_k (1 - y_k): the derivative of a `logistic` from its value."""
    return tuple(one * (1.0 - one) for one in y)


def weighted(weights, y):
    """weight_k y_k."""
    return tuple(weight * one for weight, one in zip(weights, y, strict=True))


def weighted_sum(weights, y):
    """sum_k weight_k y_k, a number."""
    return sum(weight * one for weight, one in zip(weights, y, strict=True))


def zeros_for(y):
    """As many zeros."""
    return tuple(0.0 for _ in y)


def diagonal(y):
    """A matrix, a tuple of rows, with y_k on its diagonal."""
    n = range(len(y))
    return tuple(tuple(y[k] if j == k else 0.0 for j in n) for k in n)
