"""Which law a record prefers, and by how much."""

import numpy as np
import xarray

from ....model.quantities import attrs

#: a difference of ln(likelihood) or ln(evidence) below the first decides nothing, above the second
#: it is clear
UNDECIDED, CLEAR = 1.5, 5.0


def compare_laws(results, aic, colored):
    """Dataset of differences along ``law``, and a text on them.

    Parameters
    ----------
    results : dict, law -> Dataset; `bic` and `log_evidence` are used where all have them
    aic : dict, law -> Akaike information criterion
    colored : bool, whether residuals are correlated
    """
    laws = list(results)
    difference = np.array([aic[law] for law in laws]) - min(aic.values())
    weight = np.exp(-0.5 * difference)
    weight = weight / weight.sum()
    values = {"aic_difference": difference, "akaike_weight": weight}
    if all("bic" in result for result in results.values()):
        bic = np.array([float(result["bic"]) for result in results.values()])
        values["bic_difference"] = bic - bic.min()
    sentences = [_by_likelihood(difference, weight, laws)]
    if all("log_evidence" in result for result in results.values()):
        evidence, error = (
            np.array([float(result[name]) for result in results.values()])
            for name in ("log_evidence", "log_evidence_error")
        )
        best = int(np.argmax(evidence))
        error = np.where(np.arange(len(laws)) == best, 0.0, np.hypot(error, error[best]))
        values |= {"log_bayes_factor": evidence - evidence[best], "log_bayes_factor_error": error}
        sentences.append(_by_evidence(evidence - evidence[best], error, laws))
    if colored:
        sentences.append(
            "Residuals are correlated, so that the comparison rests on the model of the noise, "
            "which counts what a law leaves unexplained as noise; small differences mean little."
        )
    variables = {name: ("law", value, attrs(name)) for name, value in values.items()}
    return xarray.Dataset(variables, {"law": laws}), " ".join(sentences)


def _ranked(values, laws):
    """Best and second law by `values` (the smaller, the better), and their difference."""
    first, second = np.argsort(values)[:2]
    return laws[first], laws[second], float(values[second] - values[first])


def _by_likelihood(aic, weight, laws):
    best, other, difference = _ranked(aic, laws)
    share = " and ".join(f"{_share(w)} ({law})" for law, w in zip(laws, weight, strict=True))
    if difference < 2.0 * UNDECIDED:
        return (
            f"The record does not decide between the laws: AIC differs by {difference:.2g}, in "
            f"favour of the {best} law (Akaike weights {share})."
        )
    how = "clearly" if difference > 2.0 * CLEAR else "somewhat"
    return (
        f"The {best} law fits {how} better than the {other} law: AIC is lower by {difference:.3g}, "
        f"which is a likelihood ratio of exp({0.5 * difference:.3g}) (Akaike weights {share})."
    )


def _share(weight):
    """An Akaike weight as text, never as certain."""
    return "> 0.99" if weight > 0.99 else "< 0.01" if weight < 0.01 else f"{weight:.2f}"


def _by_evidence(factor, error, laws):
    best, other, difference = _ranked(-factor, laws)
    second = int(np.argsort(-factor)[1])
    text = f"ln(Bayes factor) of the {best} over the {other} law is {difference:.3g} +- "
    undecided = difference < UNDECIDED + error[second]
    verdict = "which decides nothing" if undecided else "under equal priors"
    return f"{text}{error[second]:.2g}, {verdict}."
