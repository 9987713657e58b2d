"""What the cycles of a record tell, and what they do not, in words."""

import numpy as np

from ....model.quantities import readable
from ..words.trades import percent, product
from .features import FEATURES, LEVEL

# Error of a combination of parameters (of 1) beyond which it counts as not determined.
VAGUE = 0.3
# Weight in a combination below which a parameter is left out of the words.
SMALL = 0.15


def identified(names, covariance, measured):
    """Words on which combinations of parameters are known, and warnings (list of str).

    Parameters
    ----------
    names : tuple of str, the free parameters
    covariance : (k, k) of their logarithms
    measured : sequence of `Measured`
    """
    variances, axes = np.linalg.eigh(covariance)
    errors = np.sqrt(np.maximum(variances, 0.0))
    known = [f"{product(names, axes[:, i])} to {percent(errors[i])}" for i in range(len(names))]
    words = (
        "Amplitude over a, and the shape of a cycle, depend on K/K_c_qs, eta and b/a alone, and "
        "its period is so many Dc/V_lp: what leaves these alike is not told apart. Independent "
        f"combinations, best known first: {'; '.join(known)}."
    )
    vague = []
    for i in np.flatnonzero(errors > VAGUE):
        weight = np.abs(axes[:, i])
        which = [n for n, w in zip(names, weight, strict=True) if w > SMALL * weight.max()]
        remedy = "" if len(measured) > 1 else ", or add a record at another speed"
        what = (
            f"{' and '.join(which)} trade off: the cycles fix their combination "
            f"{product(names, axes[:, i])} only to {percent(errors[i])}"
            if len(which) > 1
            else f"the cycles fix {which[0]} only to {percent(errors[i])}"
        )
        vague.append(f"{what}; fix one that is known by other means{remedy}")
    notes = [note for one in measured for note in one.notes]
    said = [f"{text[0].upper()}{text[1:]}." for text in (*vague, *notes)]
    return " ".join([words, *said]), vague


def remarks(found, alike):
    """Warnings (list of str) on how well the best run fits, and on others that fit as well.

    alike : numbers of the other runs that do
    """
    said = [text for measured in found.measured for text in measured.warnings]
    best = found.runs[0]
    if best.status != "converged":
        said.append(f"the least squares ended {best.status}; the estimates are not reliable")
    if found.enlarged > 1.0:
        worst = [
            f"{name} by {_misfit(measured, fitted, i)}"
            for measured, fitted in zip(found.measured, found.fitted, strict=True)
            for i, name in enumerate(FEATURES)
            if measured.used[i]
            and abs(fitted[i] - measured.values[i]) > 2.0 * measured.covariance[i, i] ** 0.5
        ]
        said.append(
            f"the {found.law} law does not fit the cycles within their errors (chi-squared "
            f"{found.chi2:.3g} for {found.dof} degrees of freedom"
            + (f"; off: {', '.join(worst)}" if worst else "")
            + f"); errors are enlarged by {found.enlarged:.3g}"
        )
    for i in alike:
        other = ", ".join(
            f"{symbol} = {readable(symbol, found.run_values[i][symbol])}" for symbol in found.free
        )
        said.append(f"another minimum fits equally well: {other}")
    return said


def _misfit(measured, fitted, i):
    apart = fitted[i] - measured.values[i]
    return f"{apart:.2g}" if i == LEVEL else f"{100 * np.expm1(apart):.2g} %"
