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


def log(x):
    """ln x, of x > 0."""
    import numpy as np

    return np.log(x)


def larger(x, y):
    """The larger of both."""
    import numpy as np

    return np.maximum(x, y)


def tanh(x):
    """tanh x."""
    import numpy as np

    return np.tanh(x)


def asinh_of_exp(x):
    """asinh(e**x/2), which is x for large x."""
    import numpy as np

    large = np.real(x) > 0.0
    small = np.exp(-2.0 * np.where(large, x, 0.0))
    root = np.sqrt(1.0 + 4.0 * small)
    # ((1 + root)/2 less 1 is small/(1 + root) times 2, without cancellation)
    above = x + np.log1p(2.0 * small / (1.0 + root))
    return np.where(large, above, np.arcsinh(0.5 * np.exp(np.where(large, 0.0, x))))


def asinh_of(w, x):
    """asinh(w e**x/2)."""
    import numpy as np

    with np.errstate(divide="ignore"):
        return np.sign(w) * asinh_of_exp(np.log(np.abs(w)) + x)


def flash(x):
    """(1 + e**(8 x))**(-1/8)."""
    import numpy as np

    return np.exp(-0.125 * softplus(8.0 * x))


def log_2_sinh(x):
    """ln(2 sinh x), of x > 0."""
    import numpy as np

    return x + np.log(-np.expm1(-2.0 * x))


def coth(x):
    """1/tanh x, of x > 0: the derivative of `log_2_sinh`."""
    import numpy as np

    return -1.0 - 2.0 / np.expm1(-2.0 * x)


def sine(x):
    """sin(2 pi x)."""
    import numpy as np

    return np.sin(2.0 * np.pi * (x - np.round(x)))


def cosine(x):
    """cos(2 pi x)."""
    return sine(x + 0.25)


# Of tuples with a number a state


def scaled(x, y):
    """x y_k."""
    return tuple(x * one for one in y)


def added(x, y):
    """x_k + y_k."""
    return tuple(one + other for one, other in zip(x, y, strict=True))


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
