"""Parameters that trade off: the combination of them that a record determines."""

import numpy as np

from ....model.quantities import with_error
from ..estimates import ENDLESS, is_unconstrained

#: correlation from which parameters trade off, and error of a combination worth a warning
CORRELATED, LOOSE = 0.95, 0.2
#: power below which a parameter is left out of a product
SMALL = 0.1


def correlated_groups(estimates, names):
    """Groups (list of tuples) of these parameters, linked by strong correlations; none alone."""
    linked = np.abs(estimates.correlation_of(names)) > CORRELATED
    reach = np.linalg.matrix_power(linked.astype(int), max(len(names), 1)) > 0
    groups = {tuple(n for n, on in zip(names, row, strict=True) if on) for row in reach}
    return sorted(group for group in groups if len(group) > 1)


def tradeoff_text(estimates, which, rate="a - b"):
    """A text on the best-constrained combination of a group, and whether another is loose (bool).

    Combinations are the axes of the covariance of the logarithms.  `rate` is what "a_minus_b" is.
    """
    group = [estimates.of(name) for name in which]
    errors = np.array([one.relative_error for one in group])
    # b < 0 has no logarithm but that of -b, which correlates the other way
    signs = np.sign([one.value for one in group])
    correlation = estimates.correlation_of(which) * np.outer(signs, signs)
    variance, axes = np.linalg.eigh(correlation * np.outer(errors, errors))
    best, worst = np.sqrt(np.maximum(variance[[0, -1]], 0.0))
    best_text = f"{product(which, axes[:, 0])} to {percent(best)}"
    if "a" in which and "b" in which:
        difference = estimates.of("a_minus_b")
        best_text += f", and {rate} = {with_error(difference.value, difference.error)}"
    if worst < LOOSE:
        return best_text, False
    pairs = correlation[np.triu_indices(len(which), 1)]
    strongest = pairs[np.argmax(np.abs(pairs))]
    worst_text = f"{product(which, axes[:, -1])} only to {percent(worst)}"
    if is_unconstrained(worst):
        worst_text = f"does not constrain {product(which, axes[:, -1])}"
    return (
        f"{', '.join(which[:-1])} and {which[-1]} trade off (correlation {strongest:.3f}): the "
        f"record fixes {best_text}, but {worst_text}"
    ), True


def percent(error):
    """A relative error as text; a large one as a factor, of at most exp(`ENDLESS`).

    >>> percent(0.0213), percent(1.5), percent(200.0)
    ('2.1 %', 'a factor of 4.5', 'more than a factor of 1e+06')
    """
    if error > ENDLESS:
        return f"more than a factor of {np.exp(ENDLESS):.1g}"
    return f"{100.0 * error:.2g} %" if error < 0.5 else f"a factor of {np.exp(error):.2g}"


def product(names, axis):
    """A direction in logarithms as a product of powers, the largest of which is 1.

    >>> product(("Dc", "K"), np.array([0.7, 0.69])), product(("a", "b"), np.array([-0.6, 0.8]))
    ('Dc K', 'b/a^0.75')
    """
    powers = axis / axis[np.argmax(np.abs(axis))]
    over: list[str] = []
    under: list[str] = []
    for name, power in zip(names, powers, strict=True):
        if abs(power) > SMALL:
            size = "" if abs(power) > 0.95 else f"^{abs(power):.2g}"
            (over if power > 0.0 else under).append(name + size)
    below = f"({' '.join(under)})" if len(under) > 1 else "".join(under)
    return " ".join(over) + (f"/{below}" if below else "")
