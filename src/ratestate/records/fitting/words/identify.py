"""What a record tells of each parameter, in words."""

import numpy as np

from ....friction.laws import LAWS
from ....model.quantities import QUANTITIES, readable
from ..unknowns import START, to_value
from .trades import percent, relative_error, trade, traded

#: standard error of a logarithm from which a parameter counts as hardly determined
VAGUE = 0.5


def identified(known):
    """Words on what is determined, and warnings (list of str), of an `Uncertain`."""
    free = [number.name for number in known.numbers if number.plain]
    relative = {name: _relative(known, name) for name in free}
    open_sides = _open_sides(known)
    warnings = [*_search(known), *_bounds(known, open_sides)]
    sound, lacking = [], []
    for name, error in relative.items():
        if _unseen(known, name):
            warnings.append(
                f"the record tells nothing of {name}: friction is the same for all of its values; "
                f"leave {name} out of free"
            )
            lacking.append(name)
        elif name in open_sides:
            warnings.append(_one_sided(known, name, *open_sides[name]))
            lacking.append(f"{name}{_only(known, name)}")
        elif error > VAGUE:
            size = f"{error:.2g} times its value" if name == "b" else percent(error)
            warnings.append(
                f"{name} is hardly determined: its standard error is {size} "
                f"({_interval(known, name)}); fix it at a value "
                f"that is known by other means, or give a record with more or larger steps"
            )
            lacking.append(f"{name} ({_interval(known, name)})")
        else:
            sound.append(f"{name} to {percent(error)}" if name != "lag" else _lag(known))
    code = known.solution.problem.forward.law
    law = next(name for name, row in LAWS.items() if row.code == code)
    said = [_determined(sound, lacking, law)]
    for which in traded(known.estimates, [name for name in free if _covaries(known, name)]):
        text, loose = trade(known.estimates, which)
        if loose:
            warnings.append(f"{text}; fix one of them if it is known by other means")
        said.append(f"{'Together' if loose else 'Best known'}: {text}.")
    said += [f"Moreover: {text}." for text in _edges(known)]
    if START[0] in known.solution.unknowns.names:
        said.append(
            "The record begins out of steady sliding; the velocity and state there were found too."
        )
    return " ".join(said), warnings


def _determined(sound, lacking, law):
    """What is determined, and what is not."""
    if not lacking:
        return f"All free parameters are determined, if the {law} law holds: {', '.join(sound)}."
    begin = f"Determined: {', '.join(sound)}. " if sound else "Nothing is determined. "
    return f"{begin}Not determined: {', '.join(lacking)}."


def _unseen(known, name):
    return not np.isfinite(known.estimates.errors[known.estimates.names.index(name)])


def _relative(known, name):
    """Standard error of a parameter's logarithm; of b in parts of its value; 0 of a lag.

    That of an interval which is not the covariance's is half its width over 1.96.
    """
    table, i = known.estimates, known.estimates.names.index(name)
    if name == "lag":
        return 0.0
    if table.kinds[i] != "covariance":
        low, high = table.intervals[i, -1]
        with np.errstate(divide="ignore", invalid="ignore"):
            wide = (high - low) / abs(table.values[i]) if name == "b" else np.log(high / low)
        return float(wide / 3.92)
    return relative_error(table, name)


def _covaries(known, name):
    """Whether the covariance tells how well a parameter is known."""
    if name == "lag" or _unseen(known, name):
        return False
    error = relative_error(known.estimates, name)
    return bool(0.5 < _relative(known, name) / error < 2.0)


def _lag(known):
    i = known.estimates.names.index("lag")
    return f"lag to {readable('t', known.estimates.errors[i], 2)}"


def _interval(known, name):
    low, high = known.estimates.intervals[known.estimates.names.index(name), -1]
    return f"95 %: {_readable(name, low)} to {_readable(name, high)}"


def _readable(name, value):
    symbol = name if name in QUANTITIES else "t"
    return readable(symbol, float(value), 3)


def _open_sides(known):
    """name -> (lower is open, upper is open) of the parameters whose profile has no end."""
    found = {}
    for number in known.numbers:
        if number.plain and number.name in known.profiles:
            ends = known.profiles[number.name].interval()[-1]
            if not np.isfinite(ends).all():
                found[number.name] = tuple(~np.isfinite(ends))
    return found


def _only(known, name):
    """The one side on which a parameter is known, if any."""
    low, high = known.profiles[name].interval()[-1]
    if np.isfinite(low) or np.isfinite(high):
        sign, end = (">", low) if np.isfinite(low) else ("<", high)
        return f" ({sign} {_readable(name, to_value(name, end))})"
    return ""


def _one_sided(known, name, lower, upper):
    """What is known of a parameter with an open side."""
    low, high = known.profiles[name].interval()[-1]
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


def _search(known):
    """On the search itself."""
    found = []
    if not known.solution.converged:
        found.append(
            f"the least squares have not converged in {known.solution.evaluations} evaluations: "
            f"neither estimates nor errors can be trusted; start from a slider nearer to the "
            f"machine, or free fewer parameters"
        )
    if known.restless:
        found.append(
            "the profiles keep finding better fits: the likelihood has several maxima, and the "
            "estimates may be those of a lesser one; free fewer parameters"
        )
    if known.sampled is not None:
        found += _sampling(known)
    return found


def _sampling(known):
    """On the posterior."""
    sampled, found = known.sampled, []
    if not sampled.complete:
        found.append(
            f"the posterior was not complete after {sampled.evaluations} evaluations: its "
            f"quantiles and evidence are not reliable; free fewer parameters"
        )
    if not sampled.sound:
        found.append(
            f"the posterior has only {sampled.effective:.0f} effective samples: the intervals are "
            f"not its quantiles; free fewer parameters"
        )
    for number in known.numbers:
        side = sampled.cut(number)
        if side:
            end = number.si(sampled.prior[number.name][0 if side < 0 else 1])
            found.append(
                f"the posterior of {number.name} reaches the {'lower' if side < 0 else 'upper'} "
                f"end of its prior, {_readable(number.name, end)}: its quantiles, and those of "
                f"what it trades off with, are the prior's choice"
            )
    return found


def _bounds(known, open_sides):
    """On coordinates that have run to a bound."""
    found = []
    for name in known.solution.unknowns.names:
        side = known.solution.at_bound(name)
        if side and name not in open_sides:
            i = known.solution.unknowns.place(name)
            value = to_value(name, known.solution.point[i])
            shown = f"{value:.4g}" if name in START else _readable(name, value)
            found.append(
                f"{name} = {shown} has run to the {'lower' if side < 0 else 'upper'} bound of the "
                f"search, and its error means nothing; fix {name}, or check units and window"
            )
    return found


def _edges(known):
    """On numbers whose interval ends where motion does."""
    found = []
    for number in known.numbers:
        if number.name not in known.profiles:
            continue
        profile = known.profiles[number.name]
        for side, end in enumerate(profile.ends):
            if end == "edge":
                value = number.si(profile.values[-side])
                word = "above" if side else "below"
                found.append(
                    f"{number.name} ends at {_readable(number.name, value)}: {word} it no motion "
                    f"leads through the whole record"
                )
    return found
