"""Healing as text, for a notebook or a log."""

import pandas

from ...dynamics import attributes
from ...model.conversion import in_si
from ...model.quantities import readable, with_error
from ..kit.results import lines_of
from ..messages import healing as sentences
from .result import RATES

#: scatter over errors that is mentioned
SCATTER = 1.5
#: columns, as a heading has them
HEADINGS = {"delta_mu": "healing", "delta_mu_c": "relaxation"}


def summary(result):
    """Healing as plain text, to print.

    Parameters
    ----------
    result : xarray.Dataset
        From `healing`.

    Returns
    -------
    str
        A table with a row for each hold: when it begins, how long it is, the speeds before and
        after it, healing and relaxation +- standard error [1e-3], and what sliders predict; the
        rates per decade; messages on holds.

    Raises
    ------
    ParameterError
        No result of `healing`.
    """
    result = checked(result, "summary")
    parts = [heading(result), *lines_of(table(result)), "", *rates(result)]
    return "\n".join([*parts, *hold_sentences(result)])


def checked(result, caller):
    """A result of `healing` in SI; ParameterError in the name of `caller` for anything else."""
    title = getattr(result, "attrs", {}).get("title")
    if title != "ratestate healing" or "delta_mu" not in result:
        raise sentences.refusal("result.other", caller=caller)
    return in_si(result)


def heading(result):
    """What the text is about."""
    source = attributes.text(result, "source", "")
    holds = result.sizes["hold"]
    found = int((result["hold_status"] == 0).sum())
    return f"Healing{f' in {source}' if source else ''}: {found} of {holds} holds evaluated"


def table(result):
    """A pandas DataFrame of texts, a row for each hold; healing and relaxation in 1e-3."""
    columns = {
        "start": [readable("t", value, 6) for value in result["hold_start"].values],
        "hold": [readable("t", value) for value in result["t_hold"].values],
        "before": [_speed(value) for value in result["V_before"].values],
        "after": [_speed(value) for value in result["V_after"].values],
    }
    for name, head in HEADINGS.items():
        columns[f"{head} [1e-3]"] = _cells(result[name], result[f"{name}_error"])
        if f"{name}_predicted" in result:
            for law in result["law"].values:
                part = result.sel(law=law)
                cells = _cells(part[f"{name}_predicted"], part[f"{name}_predicted_error"])
                columns[f"{law} law: {head}"] = cells
    return pandas.DataFrame(columns, index=pandas.RangeIndex(1, result.sizes["hold"] + 1))


def rates(result):
    """Sentences on the rates per decade, measured and predicted (list of str)."""
    texts = []
    for name, rate in RATES.items():
        value = float(result[rate])
        if value != value:
            texts.append(sentences("rate.few", name=name))
            continue
        scatter = float(result[f"{rate}_scatter"])
        text = f"{HEADINGS[name]} per decade of hold time: {_rate(result, rate)}"
        if scatter > SCATTER:
            text += sentences("rate.scatter", scatter=scatter)
        texts.append(text)
        if f"{rate}_predicted" in result:
            texts += [
                f"  {law} law predicts {_rate(result.sel(law=law), f'{rate}_predicted')}"
                for law in result["law"].values
            ]
    return texts


def hold_sentences(result):
    """What must be known of holds (list of str), each with the number of its hold."""
    texts = enumerate(result["hold_message"].values.tolist(), start=1)
    return [f"hold {number}: {text}" for number, text in texts if text]


def _cells(values, errors):
    """Values +- errors in 1e-3, "-" for NaN."""
    pairs = zip(1e3 * values.values, 1e3 * errors.values, strict=True)
    return ["-" if value != value else with_error(value, error) for value, error in pairs]


def _rate(result, rate):
    """A rate +- its error."""
    return with_error(float(result[rate]), float(result[f"{rate}_error"]))


def _speed(V):
    return "-" if V != V else readable("V_lp", V, 3)
