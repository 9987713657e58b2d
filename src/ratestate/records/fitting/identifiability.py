"""Notes on the parameters that a record determines, and warnings on the others.

If parameters trade off, the note names the combination that the record determines.
"""

import numpy as np

from ...model.quantities import readable, with_error
from ..messages import fitting as sentences
from .by_law import rate_dependence_text
from .quantities import ENDLESS, ROOTS
from .unknowns import parameter, start_names

#: standard error of a logarithm above which a parameter counts as hardly determined
HARDLY_DETERMINED = 0.5
#: correlation from which parameters trade off; least error of a combination for a warning
CORRELATED, LOOSE = 0.95, 0.2
#: power below which a parameter is left out of a product
SMALL = 0.1


def identifiability(inference):
    """Return a note on what a record determines (str), and warnings (list of str)."""
    problem = inference.solution.problem
    free = [quantity for quantity in inference.quantities if quantity.is_free]
    pairs = [_determination(inference, quantity) for quantity in free]
    warnings = [warning for _, warning in pairs if warning]
    determined = ", ".join(text for text, warning in pairs if not warning)
    undetermined = ", ".join(text for text, warning in pairs if warning)
    which = "all" if not undetermined else "some" if determined else "none"
    lists = {"determined": determined, "undetermined": undetermined}
    notes = [sentences(f"note.{which}", law=problem.law.name, **lists)]
    for text, loose in _tradeoffs(inference, [quantity.name for quantity in free]):
        if loose:
            warnings.append(sentences("warning.tradeoff", tradeoff=text))
        notes.append(sentences(f"note.{'loose' if loose else 'tight'}", tradeoff=text))
    for quantity in inference.quantities:
        if profile := inference.profiles.get(quantity.name):
            for index, side in ((0, "below"), (-1, "above")):
                if profile.ends[index] == "edge":
                    value = float(quantity.si(profile.values[index]))
                    notes.append(sentences("note.edge", name=quantity.name, value=value, side=side))
    if start_names(problem.law)[0] in problem.unknowns.names:
        notes.append(sentences("note.start"))
    return " ".join(notes), warnings


def _determination(inference, quantity):
    """Return a parameter with its error or bound as text, and its warning or ""."""
    name, estimate = quantity.name, inference.estimates.by_name[quantity.name]
    row = parameter(name)
    remedy = sentences(f"remedy.{inference.solution.problem.kind}")
    if not np.isfinite(estimate.error):
        return name, sentences("warning.unseen", name=name)
    low, high = bounds_of(inference, quantity)
    if low is None and high is None:
        return name, sentences("warning.undetermined", name=name)
    if low is None or high is None:
        bound = f"> {readable(name, low, 3)}" if high is None else f"< {readable(name, high, 3)}"
        is_irrelevant = quantity.no_effect == (1 if high is None else -1)
        why = sentences(f"why.{name}") if is_irrelevant else ""
        return f"{name} ({bound})", sentences("warning.one_sided", name=name, bound=bound, why=why)
    if row.group != "slider":
        return f"{name} to {readable(name, estimate.error, 2)}", ""
    error = _relative_error(name, estimate)
    size = percent(error) if row.is_log else f"{error:.2g} times its value"
    if row.is_log and np.isinf(estimate.interval[-1, 1]):
        return name, sentences("warning.unconstrained", name=name, size=size, remedy=remedy)
    if error > HARDLY_DETERMINED:
        interval = f"95 %: {' to '.join(readable(name, end, 3) for end in estimate.interval[-1])}"
        values = {"size": size, "interval": interval, "remedy": remedy}
        warning = sentences("warning.vague", name=name, **values)
        return f"{name} ({interval})", warning
    return f"{name} to {percent(error)}", ""


def bounds_of(inference, quantity):
    """Return ends [SI] of a profile's 95 % interval; None: open, NaN: no profile."""
    if quantity.name not in inference.profiles:
        return np.nan, np.nan
    estimate = inference.estimates.by_name[quantity.name]
    if estimate.kind != "profile":  # intervals of a posterior are never open
        ends = quantity.si(inference.profiles[quantity.name].interval()[-1])
    else:
        ends = estimate.interval[-1]
    open_ends = quantity.si(np.array([-np.inf, np.inf]))
    return tuple(
        None if end == at_infinity else float(end)
        for end, at_infinity in zip(ends, open_ends, strict=True)
    )


def _relative_error(name, estimate):
    """Return the error of a parameter's logarithm, or of b divided by its value.

    If the interval is not from the covariance, it is the 95 % half width divided by 1.96.
    """
    if estimate.kind == "covariance":
        return estimate.relative_error
    low, high = estimate.interval[-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        is_log = parameter(name).is_log
        width = np.log(high / low) if is_log else (high - low) / abs(estimate.value)
    return float(width / 3.92)


def _tradeoffs(inference, free):
    """Return the `tradeoff_text` of groups whose covariance is a good approximation."""
    estimates, names = inference.estimates, []
    for name in (name for name in free if parameter(name).group == "slider"):
        estimate = estimates.by_name[name]
        if 0.5 < _relative_error(name, estimate) / estimate.relative_error < 2.0:
            names.append(name)
    rate = rate_dependence_text([inference.solution.problem.law])
    return [tradeoff_text(estimates, group, rate) for group in correlated_groups(estimates, names)]


def correlated_groups(estimates, names):
    """Return groups (list of tuples) of parameters linked by strong correlations."""
    linked = np.abs(estimates.correlation_of(names)) > CORRELATED
    reach = np.linalg.matrix_power(linked.astype(int), max(len(names), 1)) > 0
    groups = {tuple(n for n, on in zip(names, row, strict=True) if on) for row in reach}
    return sorted(group for group in groups if len(group) > 1)


def tradeoff_text(estimates, which, rate="a - b"):
    """Return a text on the best-constrained combination; whether another is loose.

    Combinations are principal axes of the covariance of logarithms.  "a_minus_b" is called `rate`.
    """
    group = [estimates.by_name[name] for name in which]
    errors = np.array([estimate.relative_error for estimate in group])
    # for b < 0 use ln(-b), whose correlations have the other sign
    signs = np.sign([estimate.value for estimate in group])
    correlation = estimates.correlation_of(which) * np.outer(signs, signs)
    variance, axes = np.linalg.eigh(correlation * np.outer(errors, errors))
    best, worst = np.sqrt(np.maximum(variance[[0, -1]], 0.0))
    best_text = f"{product(which, axes[:, 0])} to {percent(best)}"
    if "a" in which and "b" in which:
        difference = estimates.by_name["a_minus_b"]
        best_text += f", and {rate} = {with_error(difference.value, difference.error)}"
    if worst < LOOSE:
        return best_text, False
    pairs = correlation[np.triu_indices(len(which), 1)]
    strongest = pairs[np.argmax(np.abs(pairs))]
    worst_text = f"{product(which, axes[:, -1])} only to {percent(worst)}"
    if ROOTS[-1] * worst > ENDLESS:  # the 95 % interval is open
        worst_text = f"does not constrain {product(which, axes[:, -1])}"
    return (
        f"{', '.join(which[:-1])} and {which[-1]} trade off (correlation {strongest:.3f}): the "
        f"record fixes {best_text}, but {worst_text}"
    ), True


def percent(error):
    """Return a relative error as text; a large error as a factor.

    >>> percent(0.0213), percent(1.5), percent(200.0)
    ('2.1 %', 'a factor of 4.5', 'more than a factor of 1e+06')
    """
    if error > ENDLESS:
        return f"more than a factor of {np.exp(ENDLESS):.1g}"
    return f"{100.0 * error:.2g} %" if error < 0.5 else f"a factor of {np.exp(error):.2g}"


def product(names, axis):
    """Return a direction in logarithms as a product of powers, the largest 1.

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
