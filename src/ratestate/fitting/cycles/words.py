"""What the cycles of a record tell, and what they do not, in words."""

import numpy as np

from .features import FEATURES, LEVEL

# Error of a combination of parameters (of 1) beyond which it counts as not determined.
VAGUE = 0.3
# Weight in a combination below which a parameter is left out of the words.
SMALL = 0.15


def identified(names, covariance, speeds):
    """Words on which combinations of parameters are known, and warnings (list of str).

    Parameters
    ----------
    names : tuple of str, the free parameters
    covariance : (k, k) of their logarithms
    speeds : int, at how many speeds there are cycles
    """
    variances, axes = np.linalg.eigh(covariance)
    errors = np.sqrt(np.maximum(variances, 0.0))
    known = [f"{_product(names, axes[:, i])} to {_relative(errors[i])}" for i in range(len(names))]
    words = (
        "Amplitude over a, and the shape of a cycle, depend on K/K_c_qs, eta and b/a alone, and "
        "its period is so many Dc/V_lp: what leaves these alike is not told apart. Independent "
        f"combinations, best known first: {'; '.join(known)}."
    )
    vague = []
    for i in np.flatnonzero(errors > VAGUE):
        weight = np.abs(axes[:, i])
        which = [n for n, w in zip(names, weight, strict=True) if w > SMALL * weight.max()]
        remedy = "" if speeds > 1 else ", or add a record at another speed"
        what = (
            f"{' and '.join(which)} trade off: the cycles fix their combination "
            f"{_product(names, axes[:, i])} only to {_relative(errors[i])}"
            if len(which) > 1
            else f"the cycles fix {which[0]} only to {_relative(errors[i])}"
        )
        vague.append(f"{what}; fix one that is known by other means{remedy}")
    return " ".join([words, *(f"{text[0].upper()}{text[1:]}." for text in vague)]), vague


def _product(names, axis):
    """A direction in logarithms as a product of powers, the largest power being 1."""
    powers = axis / axis[np.argmax(np.abs(axis))]
    parts = []
    for name, power in zip(names, powers, strict=True):
        if abs(power) > SMALL:
            parts.append(name if power > 0.995 else f"{name}^{power:.2g}")
    return " ".join(parts)


def _relative(error):
    return f"{100 * error:.2g} %" if error < VAGUE else f"a factor of {np.exp(min(error, 99)):.2g}"


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
            f"{symbol} = {found.run_values[i][symbol]:.4g}" for symbol in found.names[:-1]
        )
        said.append(f"another minimum fits equally well: {other} [SI]")
    return said


def _misfit(measured, fitted, i):
    apart = fitted[i] - measured.values[i]
    return f"{apart:.2g}" if i == LEVEL else f"{100 * np.expm1(apart):.2g} %"
