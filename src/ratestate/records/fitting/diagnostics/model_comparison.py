"""Which law a record prefers, and by how much."""

from pathlib import Path

import numpy as np
import xarray

from ....model.names import Sentences
from ....model.quantities import attrs

#: a difference of ln(likelihood) or ln(evidence) below the first decides nothing, above the second
#: it is clear
UNDECIDED, CLEAR = 1.5, 5.0
SENTENCES = Sentences(Path(__file__).with_suffix(".toml"))


def compare_laws(results, aic, colored, fits=True):
    """Dataset of differences along ``law``, and a text on them; see `result.add_comparison`.

    fits : whether any of the laws fits

    ``bic_difference`` and ``log_bayes_factor`` are absent unless all laws have what they are of.
    """
    laws = list(results)

    def column(name):
        """The values under each law, or None where a law has none."""
        if all(name in result for result in results.values()):
            return np.array([float(result[name]) for result in results.values()])
        return None

    difference = np.array([aic[law] for law in laws]) - min(aic.values())
    weight = np.exp(-0.5 * difference)
    weight = weight / weight.sum()
    values = {"aic_difference": difference, "akaike_weight": weight}
    if (bic := column("bic")) is not None:
        values["bic_difference"] = bic - bic.min()
    sentences = [_by_likelihood(difference, weight, laws, fits)]
    if (evidence := column("log_evidence")) is not None:
        best, error = int(np.argmax(evidence)), column("log_evidence_error")
        factor = evidence - evidence[best]
        error = np.where(np.arange(len(laws)) == best, 0.0, np.hypot(error, error[best]))
        values |= {"log_bayes_factor": factor, "log_bayes_factor_error": error}
        sentences.append(_by_evidence(factor, error, laws))
    if colored:
        sentences.append(SENTENCES("likelihood.correlated"))
    variables = {name: ("law", value, attrs(name)) for name, value in values.items()}
    return xarray.Dataset(variables, {"law": laws}), " ".join(sentences)


def _ranked(values, laws):
    """Best and second law by `values` (the smaller, the better), and their difference."""
    first, second = np.argsort(values)[:2]
    difference = float(values[second] - values[first])
    return {"best": laws[first], "other": laws[second], "difference": difference}


def _by_likelihood(aic, weight, laws, fits):
    """The sentence on the Akaike information criterion."""
    ranked = _ranked(aic, laws)
    half = 0.5 * ranked["difference"]
    which = "clearly" if half > CLEAR else "somewhat"
    which = "undecided" if half < UNDECIDED else which if fits else "nearer"
    *others, last = (f"{_share(w)} ({law})" for law, w in zip(laws, weight, strict=True))
    weights = f"{', '.join(others)} and {last}"
    sentence = SENTENCES(f"likelihood.{which}", **ranked, half=half, weights=weights)
    none = "Neither law" if len(laws) == 2 else "None of the laws"
    return sentence if fits else f"{SENTENCES('likelihood.none_fits', none=none)} {sentence}"


def _share(weight):
    """An Akaike weight as text, never as certain."""
    return "> 0.99" if weight > 0.99 else "< 0.01" if weight < 0.01 else f"{weight:.2f}"


def _by_evidence(factor, error, laws):
    """The sentence on the evidence."""
    ranked, second = _ranked(-factor, laws), error[np.argsort(-factor)[1]]
    which = "undecided" if ranked["difference"] < UNDECIDED + second else "decided"
    return SENTENCES(f"evidence.{which}", **ranked, error=second)
