"""The Dataset of `healing`."""

import numpy as np
import xarray

from ...dynamics.results import flags
from ..kit.results import labelled
from ..load_point.stress_steps import VARIABLE, stress_range
from ..messages import healing as sentences
from .measured import EVALUATED, FEWEST_OF_HOLD, NAMES, SHORT, STATUSES
from .rate import line_of, slope_of, times_along
from .record import is_same
from .slide_noise import FEWEST

#: what has a rate per decade -> that rate
RATES = {"delta_mu": "beta", "delta_mu_c": "beta_c"}
#: errors of the level before a hold, and part of healing, beyond which its drift up to the peak is
#: mentioned
DRIFT, OF_HEALING = 3.0, 0.001
#: errors of the peak beyond which it is mentioned that a slide does not give its level by itself
TRANSIENT = 2.0


def dataset_of(record, noise, measured, sliders, predicted):
    """The Dataset, without attributes.

    measured : list of `Measured`; sliders : law -> `Fitted`; predicted : law -> list of `Predicted`
    """
    variables = _history(record.holds) | _found(measured)
    result = xarray.Dataset(variables, labelled("time", time=record.t))
    lines = labelled("time", friction=record.friction, friction_steady=_steady(record, measured))
    result = result.assign(lines)
    result = result.assign(_rates(result))
    messages = [
        _message(record, hold, one) for hold, one in zip(record.holds, measured, strict=True)
    ]
    if predicted:
        result = result.assign_coords(law=list(predicted))
        result = result.assign(_predictions(result, sliders, predicted))
        for each in predicted.values():
            messages = [
                "; ".join(filter(None, (text, one.message)))
                for text, one in zip(messages, each, strict=True)
            ]
    return result.assign(
        labelled("hold", hold_message=messages)
        | labelled(
            (),
            noise_white=noise.white,
            noise_red=noise.red,
            noise_time=noise.time if noise.red else 0.0,
        )
    )


def _history(holds):
    """What the load point does, along ``hold``."""
    return labelled(
        "hold",
        hold_start=[hold.start for hold in holds],
        t_hold=[hold.end - hold.start for hold in holds],
        V_before=[hold.V_before for hold in holds],
        V_after=[hold.V_after for hold in holds],
    )


def _found(measured):
    """What is measured, with its errors, and the status."""
    values: dict = {}
    for name in NAMES:
        pairs = np.array([one.found.get(name, (np.nan, np.nan)) for one in measured])
        values |= {name: pairs[:, 0], f"{name}_error": pairs[:, 1]}
    values["peak_time"] = np.array([one.peak_time for one in measured])
    values["hold_status"] = np.array([one.status for one in measured], np.int8)
    found = labelled("hold", **values)
    found["hold_status"][2].update(flags(dict(enumerate(STATUSES))))
    return found


def _steady(record, measured):
    """(m,) steady friction of the slide before each hold, up to the peak; NaN elsewhere."""
    steady = np.full(record.t.size, np.nan)
    for hold, one in zip(record.holds, measured, strict=True):
        if one.status == EVALUATED:
            start = np.nanmin([one.before.start, hold.start])
            first, last = np.searchsorted(record.t, (start, one.peak_time))
            steady[first:last] = one.before.at(record.along[first:last])[0]
    return steady


def _message(record, hold, measured):
    """Why something is not known of a hold, or what must be known of it; "" if nothing."""
    if measured.status == EVALUATED:
        return "; ".join(_remarks(record, hold, measured))
    short = measured.status == SHORT
    samples, fewest = (hold.during, FEWEST_OF_HOLD) if short else (hold.before, FEWEST)
    name = STATUSES[measured.status]
    return sentences(f"status.{name}", samples=samples.size, fewest=fewest)


def _remarks(record, hold, measured):
    """What must be known of a hold that is evaluated (list of str)."""
    remarks, before = [], measured.before
    if not is_same(hold.V_before, hold.V_after):
        speeds = {"before": hold.V_before, "after": hold.V_after}
        remarks.append(sentences("evaluated.other_speed", **speeds))
    change = stress_range(record.data, slice(hold.before[0], hold.after[-1] + 1))
    if change > VARIABLE:
        remarks.append(sentences("evaluated.stress_varies", percent=100.0 * change))
    level, error = before.at(before.end)
    drift = before.at(measured.along)[0] - level
    if abs(drift) > max(DRIFT * error, OF_HEALING * abs(measured.found["delta_mu"][0])):
        remarks.append(sentences("evaluated.drift", drift=drift, error=error))
    if before.own_error > TRANSIENT * measured.found["friction_peak"][1]:
        remarks.append(sentences("evaluated.transient"))
    return remarks


def _rates(result):
    """Rates per decade, and the lines of which they are the slopes."""
    t_hold = result["t_hold"].values
    values: dict = {}
    lines: dict = {"line_t_hold": times_along(t_hold)}
    for name, rate in RATES.items():
        line = line_of(t_hold, result[name].values, result[f"{name}_error"].values)
        numbers = (np.nan,) * 3 if line is None else (line.slope, line.slope_error, line.scatter)
        names = (rate, f"{rate}_error", f"{rate}_scatter")
        values |= dict(zip(names, numbers, strict=True))
        at = np.full((2, lines["line_t_hold"].size), np.nan)
        if line is not None:
            at = line.at(np.log10(lines["line_t_hold"]))
        lines |= {f"line_{name}": at[0], f"line_{name}_error": at[1]}
    return labelled((), **values) | labelled("line", **lines)


def _predictions(result, sliders, predicted):
    """Predicted healing and relaxation along ``law`` and ``hold``, their rates along ``law``."""
    variables: dict = {}
    for i, (name, rate) in enumerate(RATES.items()):
        columns: dict = {key: [] for key in ("", "_error")}
        rates: dict = {key: [] for key in ("", "_error")}
        at = result["t_hold"].values, result[f"{name}_error"].values
        for law, each in predicted.items():
            values = np.array([one.values[i] for one in each])
            by = np.array([one.derivatives[i] for one in each])
            columns[""].append(values)
            columns["_error"].append(sliders[law].propagated(by))
            # (the slope is a linear function of the values)
            slopes = [slope_of(at[0], column, at[1]) for column in (values, *by.T)]
            rates[""].append(slopes[0])
            rates["_error"].append(sliders[law].propagated(np.array([slopes[1:]]))[0])
        names = f"{name}_predicted", f"{rate}_predicted"
        variables |= labelled(("law", "hold"), **{names[0] + k: x for k, x in columns.items()})
        variables |= labelled("law", **{names[1] + k: x for k, x in rates.items()})
    return variables
