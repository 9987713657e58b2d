"""The functions of formulas in mpmath's numbers, by which formulas can be run with these."""

import mpmath as mp


class Exact:
    """mpmath's functions, and those that it lacks."""

    def __getattr__(self, name):
        return getattr(mp, name)

    def bounded_exp(self, x):
        return mp.exp(x)

    def exp_and_inverse(self, x):
        return mp.exp(x), mp.exp(-x)

    def softplus(self, x):
        return mp.log(1 + mp.exp(x))

    def logistic(self, x):
        return 1 / (1 + mp.exp(-x))

    def asinh_of_exp(self, x):
        return mp.asinh(mp.exp(x))

    def log1p(self, x):
        return mp.log(1 + x)

    def abs(self, x):
        return abs(x)


EXACT = mp.mpf.functions = Exact()


def exact_function(name):
    """The function of this name."""
    return getattr(EXACT, name)
