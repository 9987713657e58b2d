"""Build the Dataset that `healing` returns, with its rates per decade."""

import numpy as np
import xarray

from ...dynamics.results import flags
from ...model.quantities import with_error
from ..kit.regression import Line, weighted_line
from ..kit.results import labelled
from ..load_point.stress_steps import VARIABLE, stress_range
from ..messages import healing as sentences
from .holds import FEWEST
from .measured import EVALUATED, FEWEST_OF_HOLD, NAMES, SHORT, STATUSES

#: quantity -> its rate per decade; quantity -> its heading in the text
RATES = {"delta_mu": "beta", "delta_mu_c": "beta_c"}
HEADINGS = {"delta_mu": "healing", "delta_mu_c": "relaxation"}
#: drift up to the peak above which a remark is made: in errors of the level, and as a fraction of
#: healing
DRIFT, OF_HEALING = 3.0, 0.001
#: error of a slide's level, in errors of the peak, above which a remark is made
TRANSIENT = 2.0
#: points of the line through the holds; difference of log10 below which hold times count as one
POINTS, SAME = 41, 1e-3
#: scatter divided by errors above which the text mentions it
SCATTER = 1.5
#: line through too few holds
UNKNOWN = Line(*[np.nan] * len(Line._fields))


def dataset_of(record, noise, measured, sliders, predicted):
    """Return the Dataset without attributes.

    measured : list of `MeasuredHold`
    sliders : law -> `Fitted`
    predicted : law -> list of the results of `predict`
    """
    holds, none = record.holds, (np.nan, np.nan)
    t_hold = np.array([hold.duration for hold in holds])
    columns = {name: np.array([one.values.get(name, none) for one in measured]).T for name in NAMES}
    quantities = {name: tuple(column) for name, column in columns.items()}
    messages = []
    for hold, one, *others in zip(holds, measured, *predicted.values(), strict=True):
        texts = [_message(record, hold, one), *(message for _, message in others)]
        messages.append("; ".join(filter(None, texts)))
    variables = labelled(
        "hold",
        hold_start=[hold.during.start for hold in holds],
        t_hold=t_hold,
        V_before=[hold.before.V for hold in holds],
        V_after=[hold.after.V for hold in holds],
        **quantities,
        peak_time=np.array([one.peak_time for one in measured]),
        hold_status=np.array([one.status for one in measured], np.int8),
        hold_message=messages,
    )
    variables["hold_status"][2].update(flags(dict(enumerate(STATUSES))))
    line_t = np.geomspace(t_hold.min(), t_hold.max(), POINTS)
    variables |= labelled("line", line_t_hold=line_t)
    for name, rate in RATES.items():
        line = _line(t_hold, *quantities[name])
        variables |= labelled((), **{rate: (line.slope, line.slope_error)})
        variables |= labelled((), **{f"{rate}_scatter": line.scatter})
        variables |= labelled("line", **{f"line_{name}": line.at(np.log10(line_t))})
    variables |= _predictions(t_hold, quantities, sliders, predicted) if predicted else {}
    variables |= labelled(
        (),
        noise_white=noise.white,
        noise_red=noise.red,
        noise_time=noise.time if noise.red else 0.0,
    )
    variables |= labelled(
        "time", friction=record.friction, friction_steady=_steady(record, measured)
    )
    laws = {"law": list(predicted)} if predicted else {}
    return xarray.Dataset(variables, labelled("time", time=record.t) | laws)


def _steady(record, measured):
    """Return steady friction (m,) from the slide before each hold to the peak; NaN elsewhere."""
    steady = np.full(record.t.size, np.nan)
    for hold, one in zip(record.holds, measured, strict=True):
        if one.status == EVALUATED:
            start = np.nanmin([one.before.start, hold.during.start])
            first, last = np.searchsorted(record.t, (start, one.peak_time))
            steady[first:last] = one.before.at(record.drift_coordinate[first:last])[0]
    return steady


def _message(record, hold, measured):
    if measured.status != EVALUATED:
        short = measured.status == SHORT
        part, fewest = (hold.during, FEWEST_OF_HOLD) if short else (hold.before, FEWEST)
        name = STATUSES[measured.status]
        return sentences(f"status.{name}", samples=part.rows.size, fewest=fewest)
    remarks, before = [], measured.before
    if not hold.is_at_one_speed:
        speeds = {"before": hold.before.V, "after": hold.after.V}
        remarks.append(sentences("evaluated.other_speed", **speeds))
    change = stress_range(record.data, slice(hold.before.rows[0], hold.after.rows[-1] + 1))
    if change > VARIABLE:
        remarks.append(sentences("evaluated.stress_varies", percent=100.0 * change))
    level, error = before.at(before.end)
    drift = before.at(measured.drift_coordinate)[0] - level
    if abs(drift) > max(DRIFT * error, OF_HEALING * abs(measured.values["delta_mu"][0])):
        remarks.append(sentences("evaluated.drift", drift=drift, error=error))
    if before.error_alone > TRANSIENT * measured.values["friction_peak"][1]:
        remarks.append(sentences("evaluated.transient"))
    return "; ".join(remarks)


def _predictions(t_hold, quantities, sliders, predicted):
    variables: dict = {}
    for i, (name, rate) in enumerate(RATES.items()):
        columns, rates = [], []
        for law, each in predicted.items():
            values = np.array([one[i] for one, _ in each])  # (holds, cases)
            slopes = [_line(t_hold, column, quantities[name][1]).slope for column in values.T]
            columns.append((values[:, 0], sliders[law].error(values)))
            rates.append((slopes[0], *sliders[law].error(np.array([slopes]))))
        pairs = tuple(np.stack(columns, axis=1))
        variables |= labelled(("law", "hold"), **{f"{name}_predicted": pairs})
        variables |= labelled("law", **{f"{rate}_predicted": tuple(np.transpose(rates))})
    return variables


def _line(t_hold, values, errors):
    """Return the `Line` of known values (n,) against log10 of hold time.

    It is NaN without two different hold times.
    """
    known = np.isfinite(values) & np.isfinite(errors) & (errors > 0.0)
    x = np.log10(t_hold[known])
    if x.size < 2 or np.ptp(x) < SAME:
        return UNKNOWN
    return weighted_line(x, values[known], errors[known])


def rate_text(result, name):
    """Return a sentence on the measured rate per decade."""
    value, error = (float(result[RATES[name] + end]) for end in ("", "_error"))
    if np.isnan(value):
        return sentences("rate.few", name=name)
    scatter = float(result[f"{RATES[name]}_scatter"])
    text = f"{HEADINGS[name]} per decade of hold time: {with_error(value, error)}"
    return text + (sentences("rate.scatter", scatter=scatter) if scatter > SCATTER else "")
