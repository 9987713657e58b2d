"""A note on which parameters a record determines, and warnings on those it does not."""

import numpy as np

from ....friction.laws import LAWS
from ....model.quantities import QUANTITIES, readable
from ..unknowns import START, to_value
from .tradeoffs import correlated_groups, percent, relative_error, tradeoff_text

#: standard error of a logarithm above which a parameter counts as hardly determined
VAGUE = 0.5


def identifiability(inference):
    """A note on what an `Inference` determines (str), and warnings (list of str)."""
    free = [q.name for q in inference.quantities if q.is_coordinate]
    relative = {name: _relative_error(inference, name) for name in free}
    open_sides = _open_sides(inference)
    warnings = [*_search_warnings(inference), *_bound_warnings(inference, open_sides)]
    determined, undetermined = [], []
    for name, error in relative.items():
        if _is_unseen(inference, name):
            warnings.append(
                f"the record tells nothing of {name}: friction is the same for all of its values; "
                f"leave {name} out of free"
            )
            undetermined.append(name)
        elif name in open_sides:
            warnings.append(_one_sided_warning(inference, name, *open_sides[name]))
            undetermined.append(f"{name}{_bound_text(inference, name)}")
        elif error > VAGUE:
            size = f"{error:.2g} times its value" if name == "b" else percent(error)
            warnings.append(
                f"{name} is hardly determined: its standard error is {size} "
                f"({_interval_text(inference, name)}); fix it at a value "
                f"that is known by other means, or give a record with more or larger steps"
            )
            undetermined.append(f"{name} ({_interval_text(inference, name)})")
        else:
            determined.append(f"{name} to {percent(error)}" if name != "lag" else _lag(inference))
    code = inference.solution.problem.forward.law
    law = next(name for name, row in LAWS.items() if row.code == code)
    sentences = [_determined_text(determined, undetermined, law)]
    names = [name for name in free if _has_covariance(inference, name)]
    for which in correlated_groups(inference.estimates, names):
        text, loose = tradeoff_text(inference.estimates, which)
        if loose:
            warnings.append(f"{text}; fix one of them if it is known by other means")
        sentences.append(f"{'Together' if loose else 'Best constrained'}: {text}.")
    sentences += [f"Moreover: {text}." for text in _edge_texts(inference)]
    if START[0] in inference.solution.unknowns.names:
        sentences.append(
            "The record begins out of steady sliding; its first velocity and state were estimated "
            "too."
        )
    return " ".join(sentences), warnings


def _determined_text(determined, undetermined, law):
    """The parameters that are determined, and those that are not."""
    listed = ", ".join(determined)
    if not undetermined:
        return f"All free parameters are determined, if the {law} law holds: {listed}."
    begin = f"Determined: {listed}. " if determined else "Nothing is determined. "
    return f"{begin}Not determined: {', '.join(undetermined)}."


def _is_unseen(inference, name):
    """Whether a parameter has no effect on friction."""
    return not np.isfinite(inference.estimates.errors[inference.estimates.names.index(name)])


def _relative_error(inference, name):
    """Standard error of a parameter's logarithm; of b over its value; 0 of a lag.

    Where the interval is not from the covariance: half the width of the 95 % interval over 1.96.
    """
    table, i = inference.estimates, inference.estimates.names.index(name)
    if name == "lag":
        return 0.0
    if table.kinds[i] != "covariance":
        low, high = table.intervals[i, -1]
        with np.errstate(divide="ignore", invalid="ignore"):
            width = (high - low) / abs(table.values[i]) if name == "b" else np.log(high / low)
        return float(width / 3.92)
    return relative_error(table, name)


def _has_covariance(inference, name):
    """Whether a parameter's error is about that from the covariance."""
    if name == "lag" or _is_unseen(inference, name):
        return False
    error = relative_error(inference.estimates, name)
    return bool(0.5 < _relative_error(inference, name) / error < 2.0)


def _lag(inference):
    i = inference.estimates.names.index("lag")
    return f"lag to {readable('t', inference.estimates.errors[i], 2)}"


def _interval_text(inference, name):
    low, high = inference.estimates.intervals[inference.estimates.names.index(name), -1]
    return f"95 %: {_readable(name, low)} to {_readable(name, high)}"


def _readable(name, value):
    symbol = name if name in QUANTITIES else "t"
    return readable(symbol, float(value), 3)


def _open_sides(inference):
    """name -> (lower is open, upper is open) of the parameters with an open interval."""
    sides = {}
    for q in inference.quantities:
        if q.is_coordinate and q.name in inference.profiles:
            ends = inference.profiles[q.name].interval()[-1]
            if not np.isfinite(ends).all():
                sides[q.name] = tuple(~np.isfinite(ends))
    return sides


def _bound_text(inference, name):
    """The one side on which a parameter is bounded, if any."""
    low, high = inference.profiles[name].interval()[-1]
    if np.isfinite(low) or np.isfinite(high):
        sign, end = (">", low) if np.isfinite(low) else ("<", high)
        return f" ({sign} {_readable(name, to_value(name, end))})"
    return ""


def _one_sided_warning(inference, name, lower, upper):
    """The warning of an interval with an open side."""
    low, high = inference.profiles[name].interval()[-1]
    if lower and upper:
        return (
            f"the record does not determine {name} at all: no value between the bounds of the "
            f"search is unlikely; leave {name} out of free"
        )
    sign, end = ("<", high) if lower else (">", low)
    why = ""
    if name == "K" and upper:
        why = ": the machine is too stiff for the record to tell its stiffness"
    elif name == "M" and lower:
        why = ": no inertia is seen, and M = 0 fits as well"
    return (
        f"the record only says {name} {sign} {_readable(name, to_value(name, end))} (95 %){why}; "
        f"its estimate and standard error mean nothing beyond that"
    )


def _search_warnings(inference):
    """Warnings on the search itself."""
    warnings = []
    if not inference.solution.converged:
        warnings.append(
            f"the least squares have not converged in {inference.solution.evaluations} "
            f"evaluations: neither estimates nor errors can be trusted; start from a slider "
            f"nearer to the machine, or free fewer parameters"
        )
    if inference.still_improving:
        warnings.append(
            "the profiles keep finding better fits: the likelihood has several maxima, and the "
            "estimates may be those of a lesser one; free fewer parameters"
        )
    if inference.posterior is not None:
        warnings += _posterior_warnings(inference)
    return warnings


def _posterior_warnings(inference):
    """Warnings on the posterior."""
    posterior, warnings = inference.posterior, []
    if not posterior.complete:
        warnings.append(
            f"the posterior was not complete after {posterior.evaluations} evaluations: its "
            f"quantiles and evidence are not reliable; free fewer parameters"
        )
    if not posterior.reliable:
        warnings.append(
            f"the posterior has only {posterior.effective:.0f} effective samples: the intervals "
            f"are not its quantiles; free fewer parameters"
        )
    for quantity in inference.quantities:
        side = posterior.truncated_side(quantity)
        if side:
            end = quantity.si(posterior.prior[quantity.name][0 if side < 0 else 1])
            warnings.append(
                f"the posterior of {quantity.name} reaches the {'lower' if side < 0 else 'upper'} "
                f"end of its prior, {_readable(quantity.name, end)}: its quantiles, and those of "
                f"what it trades off with, are the prior's choice"
            )
    return warnings


def _bound_warnings(inference, open_sides):
    """Warnings on coordinates at a bound."""
    warnings = []
    for name in inference.solution.unknowns.names:
        side = inference.solution.at_bound(name)
        if side and name not in open_sides:
            i = inference.solution.unknowns.index_of(name)
            value = to_value(name, inference.solution.point[i])
            shown = f"{value:.4g}" if name in START else _readable(name, value)
            warnings.append(
                f"{name} = {shown} has run to the {'lower' if side < 0 else 'upper'} bound of the "
                f"search, and its error means nothing; fix {name}, or check units and window"
            )
    return warnings


def _edge_texts(inference):
    """Texts on quantities whose interval ends where motion does."""
    texts = []
    for quantity in inference.quantities:
        if quantity.name not in inference.profiles:
            continue
        profile = inference.profiles[quantity.name]
        for side, end in enumerate(profile.ends):
            if end == "edge":
                value = quantity.si(profile.values[-side])
                word = "above" if side else "below"
                texts.append(
                    f"{quantity.name} ends at {_readable(quantity.name, value)}: {word} it no "
                    f"motion leads through the whole record"
                )
    return texts
