"""Notes and warnings on a fit of cycles."""

import numpy as np

from ....model.quantities import readable
from ..diagnostics.tradeoffs import percent, product
from .features import FEATURES, LEVEL

# Relative error of a combination of parameters beyond which it counts as not determined.
VAGUE = 0.3
# Weight in a combination below which a parameter is not mentioned.
SMALL = 0.15


def identifiability(names, covariance, measured):
    """A note on the combinations of parameters that are known (str), and warnings (list of str).

    Parameters
    ----------
    names : tuple of str, the free parameters
    covariance : (k, k) of their logarithms
    measured : sequence of `Measured`
    """
    variances, axes = np.linalg.eigh(covariance)
    errors = np.sqrt(np.maximum(variances, 0.0))
    combinations = [
        f"{product(names, axes[:, i])} to {percent(errors[i])}" for i in range(len(names))
    ]
    note = (
        "Amplitude over a, period over Dc/V_lp and shape of a cycle depend on K/K_c_qs, eta and "
        "b/a alone: parameters that leave all three unchanged cannot be distinguished. Independent "
        f"combinations, best-constrained first: {'; '.join(combinations)}."
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
    notes = [text for one in measured for text in one.notes]
    sentences = [f"{text[0].upper()}{text[1:]}." for text in (*vague, *notes)]
    return " ".join([note, *sentences]), vague


def fit_warnings(fit, alike):
    """Warnings (list of str) on how well the best run fits, and on others that fit as well.

    alike : indices of those other runs
    """
    warnings = [text for measured in fit.measured for text in measured.warnings]
    best = fit.runs[0]
    if best.status != "converged":
        warnings.append(f"the least squares ended {best.status}; the estimates are not reliable")
    if fit.enlarged > 1.0:
        worst = [
            f"{name} by {_difference(measured, features, i)}"
            for measured, features in zip(fit.measured, fit.fitted_features, strict=True)
            for i, name in enumerate(FEATURES)
            if measured.used[i]
            and abs(features[i] - measured.values[i]) > 2.0 * measured.covariance[i, i] ** 0.5
        ]
        warnings.append(
            f"the {fit.law} law does not fit the cycles within their errors (chi-squared "
            f"{fit.chi2:.3g} for {fit.dof} degrees of freedom"
            + (f"; off: {', '.join(worst)}" if worst else "")
            + f"); errors are enlarged by {fit.enlarged:.3g}"
        )
    for i in alike:
        other = ", ".join(
            f"{symbol} = {readable(symbol, fit.run_values[i][symbol])}" for symbol in fit.free
        )
        warnings.append(f"another minimum fits equally well: {other}")
    return warnings


def _difference(measured, features, i):
    """Difference of a feature from the measured one; relative, but for the level."""
    difference = features[i] - measured.values[i]
    return f"{difference:.2g}" if i == LEVEL else f"{100 * np.expm1(difference):.2g} %"
