"""A note on which parameters a record determines, and warnings on those it does not."""

from pathlib import Path

import numpy as np

from ....friction.laws import LAWS
from ....model.quantities import readable
from ....model.sentences import Sentences
from ..unknowns import START
from .tradeoffs import correlated_groups, percent, tradeoff_text

#: standard error of a logarithm above which a parameter counts as hardly determined
VAGUE = 0.5
SENTENCES = Sentences(Path(__file__).with_suffix(".toml"))


def identifiability(inference):
    """A note on what an `Inference` determines (str), and warnings (list of str)."""
    estimates, warnings = inference.estimates, []
    determined, undetermined, with_covariance = [], [], []
    for quantity in inference.quantities:
        if not quantity.is_coordinate:
            continue
        name, estimate = quantity.name, estimates.of(quantity.name)
        error = _relative_error(name, estimate)
        interval = f"95 %: {' to '.join(readable(name, end, 3) for end in estimate.interval[-1])}"
        bounds = bounds_of(inference, quantity)
        if not np.isfinite(estimate.error):
            warnings.append(SENTENCES("warning.unseen", name=name))
            undetermined.append(name)
            continue
        if None in bounds:
            warning, bound = _one_sided(name, bounds)
            warnings.append(warning)
            undetermined.append(f"{name}{bound}")
        elif error > VAGUE:
            size = f"{error:.2g} times its value" if name == "b" else percent(error)
            warnings.append(SENTENCES("warning.vague", name=name, size=size, interval=interval))
            undetermined.append(f"{name} ({interval})")
        else:
            size = readable("lag", estimate.error, 2) if name == "lag" else percent(error)
            determined.append(f"{name} to {size}")
        # an error that is about that from the covariance
        if name != "lag" and 0.5 < error / estimate.relative_error < 2.0:
            with_covariance.append(name)
    code = inference.solution.problem.forward.law
    law = next(name for name, row in LAWS.items() if row.code == code)
    which = "all" if not undetermined else "some" if determined else "none"
    lists = {"determined": ", ".join(determined), "undetermined": ", ".join(undetermined)}
    sentences = [SENTENCES(f"note.{which}", law=law, **lists)]
    for group in correlated_groups(estimates, with_covariance):
        text, loose = tradeoff_text(estimates, group)
        if loose:
            warnings.append(SENTENCES("warning.tradeoff", tradeoff=text))
        sentences.append(SENTENCES(f"note.{'loose' if loose else 'tight'}", tradeoff=text))
    sentences += _edges(inference)
    if START[0] in inference.solution.unknowns.names:
        sentences.append(SENTENCES("note.start"))
    return " ".join(sentences), warnings


def bounds_of(inference, quantity):
    """Ends [SI] of the 95 % interval by the profile of a coordinate; None where it is open."""
    if quantity.name not in inference.profiles:
        return ()
    ends = inference.profiles[quantity.name].interval()[-1]
    return tuple(float(quantity.si(end)) if np.isfinite(end) else None for end in ends)


def _relative_error(name, estimate):
    """Standard error of a parameter's logarithm; of b over its value; 0 of a lag.

    Where the interval is not from the covariance: half the width of the 95 % interval over 1.96.
    """
    if name == "lag":
        return 0.0
    if estimate.kind == "covariance":
        return estimate.relative_error
    low, high = estimate.interval[-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        width = (high - low) / abs(estimate.value) if name == "b" else np.log(high / low)
    return float(width / 3.92)


def _one_sided(name, bounds):
    """The warning of an interval with an open side, and the bound on the other, if there is one."""
    low, high = bounds
    if low is None and high is None:
        return SENTENCES("warning.undetermined", name=name), ""
    bound = f"> {readable(name, low, 3)}" if high is None else f"< {readable(name, high, 3)}"
    # beyond such a side the parameter ceases to matter
    endless = (name == "K" and high is None) or (name == "M" and low is None)
    why = SENTENCES(f"why.{name}") if endless else ""
    return SENTENCES("warning.one_sided", name=name, bound=bound, why=why), f" ({bound})"


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
