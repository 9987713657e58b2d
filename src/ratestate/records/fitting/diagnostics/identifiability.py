"""A note on which parameters a record determines, and warnings on those it does not."""

from pathlib import Path

import numpy as np

from ....model.names import Sentences
from ....model.quantities import readable
from ..table import rate_dependence_text
from ..unknowns import parameter, starts_of
from .tradeoffs import correlated_groups, percent, tradeoff_text

#: standard error of a logarithm above which a parameter counts as hardly determined
HARDLY_DETERMINED = 0.5
SENTENCES = Sentences(Path(__file__).with_suffix(".toml"))


def identifiability(inference):
    """A note on what an `Inference` determines (str), and warnings (list of str)."""
    quantities = [quantity for quantity in inference.quantities if quantity.is_coordinate]
    each = [_determination(inference, quantity) for quantity in quantities]
    warnings = [warning for _, warning in each if warning]
    determined = [text for text, warning in each if not warning]
    undetermined = [text for text, warning in each if warning]
    sentences = [_determined_or_not(inference, determined, undetermined)]
    for text, loose in _tradeoffs(inference):
        if loose:
            warnings.append(SENTENCES("warning.tradeoff", tradeoff=text))
        sentences.append(SENTENCES(f"note.{'loose' if loose else 'tight'}", tradeoff=text))
    sentences += _edges(inference)
    solution = inference.solution
    if starts_of(solution.problem.law)[0] in solution.unknowns.names:
        sentences.append(SENTENCES("note.start"))
    return " ".join(sentences), warnings


def _determination(inference, quantity):
    """A parameter with its error, bound or interval, for the note; its warning, "" without one."""
    name, estimate = quantity.name, inference.estimates.of(quantity.name)
    if not np.isfinite(estimate.error):
        return name, SENTENCES("warning.unseen", name=name)
    bounds = bounds_of(inference, quantity)
    if None in bounds:
        return _one_sided(name, bounds)
    if parameter(name).group != "slider":
        return f"{name} to {readable(name, estimate.error, 2)}", ""
    error, is_log = _relative_error(name, estimate), parameter(name).is_log
    size = percent(error) if is_log else f"{error:.2g} times its value"
    if is_log and np.isinf(estimate.interval[-1, 1]):
        return name, SENTENCES("warning.unconstrained", name=name, size=size)
    if error > HARDLY_DETERMINED:
        interval = f"95 %: {' to '.join(readable(name, end, 3) for end in estimate.interval[-1])}"
        warning = SENTENCES("warning.vague", name=name, size=size, interval=interval)
        return f"{name} ({interval})", warning
    return f"{name} to {percent(error)}", ""


def _determined_or_not(inference, determined, undetermined):
    """The sentence that lists what is determined under the law, and what is not."""
    law = inference.solution.problem.law.name
    which = "all" if not undetermined else "some" if determined else "none"
    lists = {"determined": ", ".join(determined), "undetermined": ", ".join(undetermined)}
    return SENTENCES(f"note.{which}", law=law, **lists)


def _tradeoffs(inference):
    """`tradeoff_text` of parameters whose error is about that from the covariance."""
    estimates, names = inference.estimates, []
    free = [quantity.name for quantity in inference.quantities if quantity.is_coordinate]
    for name in (name for name in free if parameter(name).group == "slider"):
        estimate = estimates.of(name)
        if 0.5 < _relative_error(name, estimate) / estimate.relative_error < 2.0:
            names.append(name)
    rate = rate_dependence_text([inference.solution.problem.law])
    return [tradeoff_text(estimates, group, rate) for group in correlated_groups(estimates, names)]


def bounds_of(inference, quantity):
    """(low, high) [SI] of the 95 % interval by a profile, None for an open end; () without one."""
    if quantity.name not in inference.profiles:
        return ()
    estimate = inference.estimates.of(quantity.name)
    if estimate.kind != "profile":  # but that of a posterior, which is never open
        ends = quantity.si(inference.profiles[quantity.name].interval()[-1])
    else:
        ends = estimate.interval[-1]
    open_ends = quantity.si(np.array([-np.inf, np.inf]))
    return tuple(
        None if end == at_infinity else float(end)
        for end, at_infinity in zip(ends, open_ends, strict=True)
    )


def _relative_error(name, estimate):
    """Standard error of a parameter's logarithm; of b over its value.

    Where the interval is not from the covariance: half the width of the 95 % interval over 1.96.
    """
    if estimate.kind == "covariance":
        return estimate.relative_error
    low, high = estimate.interval[-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        is_log = parameter(name).is_log
        width = np.log(high / low) if is_log else (high - low) / abs(estimate.value)
    return float(width / 3.92)


def _one_sided(name, bounds):
    """A parameter with the bound on its closed side, if there is one, and its warning."""
    low, high = bounds
    if low is None and high is None:
        return name, SENTENCES("warning.undetermined", name=name)
    bound = f"> {readable(name, low, 3)}" if high is None else f"< {readable(name, high, 3)}"
    is_irrelevant = parameter(name).irrelevant == (1 if high is None else -1)
    why = SENTENCES(f"why.{name}") if is_irrelevant else ""
    return f"{name} ({bound})", SENTENCES("warning.one_sided", name=name, bound=bound, why=why)


def _edges(inference):
    """Sentences on quantities whose interval ends where motion does."""
    for quantity in inference.quantities:
        if quantity.name not in inference.profiles:
            continue
        profile = inference.profiles[quantity.name]
        for side, end in enumerate(profile.ends):
            if end == "edge":
                value = float(quantity.si(profile.values[-side]))
                yield SENTENCES(
                    "note.edge", name=quantity.name, value=value, side=("below", "above")[side]
                )
