"""The functions of formulas in mpmath's numbers."""

import mpmath as mp

#: those that mpmath has under no name of its own
EXACT = {
    "softplus": lambda x: mp.log(1 + mp.exp(x)),
    "logistic": lambda x: 1 / (1 + mp.exp(-x)),
    "asinh_of_exp": lambda x: mp.asinh(mp.exp(x)),
    "log1p": lambda x: mp.log(1 + x),
    "abs": abs,
    "bounded_exp": mp.exp,
}


def exact_function(name):
    """The function of this name."""
    return EXACT[name] if name in EXACT else getattr(mp, name)
