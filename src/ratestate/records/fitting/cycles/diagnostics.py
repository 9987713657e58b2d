"""Notes and warnings on a fit of cycles."""

import numpy as np

from ....model.quantities import readable
from ..diagnostics.identifiability import percent, product
from ..estimates import is_unconstrained
from .features import FEATURES, LEVEL
from .search import distinct_runs
from .segments import SENTENCES

# Relative error of a combination of parameters beyond which it counts as not determined.
UNDETERMINED = 0.3
# Weight in a combination below which a parameter is not mentioned.
SMALL = 0.15
# Runs with a chi-squared this near to the best one's fit equally well.
EQUAL = 4.0


def diagnose(fit):
    """A note on the combinations of parameters that are determined (str), and warnings (list).

    fit : `CyclesFit`
    """
    names, free = fit.free, slice(len(fit.free))
    variances, axes = np.linalg.eigh(fit.covariance[free, free])
    products = [product(names, axis) for axis in axes.T]
    errors = np.sqrt(np.maximum(variances, 0.0))
    combinations = [f"{p} to {percent(e)}" for p, e in zip(products, errors, strict=True)]
    remedy = "" if len(fit.measured) > 1 else ", or add a record at another speed"
    vague = []
    for i in np.flatnonzero(errors > UNDETERMINED):
        weight = np.abs(axes[:, i])
        which = [n for n, w in zip(names, weight, strict=True) if w > SMALL * weight.max()]
        values = {"which": " and ".join(which), "product": products[i], "error": percent(errors[i])}
        sentence = "several" if len(which) > 1 else "one"
        sentence = "unconstrained" if is_unconstrained(errors[i]) else sentence
        vague.append(SENTENCES(f"note.{sentence}", **values, remedy=remedy))
    notes = [*vague, *(text for measured in fit.measured for text in measured.notes)]
    sentences = [f"{text[0].upper()}{text[1:]}." for text in notes]
    note = SENTENCES("note.combinations", combinations="; ".join(combinations))
    return " ".join([note, *sentences]), [*fit.left_out, *_fit_warnings(fit), *vague]


def _fit_warnings(fit):
    """Warnings on how well the best run fits, and on others that fit as well."""
    for measured in fit.measured:
        yield from measured.warnings
    best = fit.runs[0]
    if best.status != "converged":
        yield SENTENCES("warning.ended", status=best.status)
    if fit.enlarged > 1.0:
        off = ", ".join(_differences(fit))
        yield SENTENCES(
            "warning.misfit",
            law=fit.law,
            chi2=best.chi2,
            dof=fit.dof,
            off=off and f"; off: {off}",
            enlarged=fit.enlarged,
        )
    for i in distinct_runs(fit.runs, fit.enlarged**2 * best.covariance)[1:]:
        if fit.runs[i].chi2 - best.chi2 < EQUAL:
            values = (f"{s} = {readable(s, fit.run_values[i][s])}" for s in fit.free)
            yield SENTENCES("warning.alike", values=", ".join(values))


def _differences(fit):
    """The features that are off by more than two errors; relative, but for the level."""
    for measured, features in zip(fit.measured, fit.fitted_features, strict=True):
        difference = features - measured.values
        errors = np.sqrt(np.diag(measured.covariance))
        for i in np.flatnonzero(measured.used & (np.abs(difference) > 2.0 * errors)):
            by = difference[i]
            size = f"{by:.2g}" if i == LEVEL else f"{100 * np.expm1(by):.2g} %"
            yield f"{FEATURES[i]} by {size}"
