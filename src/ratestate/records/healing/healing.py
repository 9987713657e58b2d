"""The function `healing`: frictional healing in the holds of a record, and its rate per decade."""

import json

import numpy as np
import xarray

from ...dynamics.recipe import versions
from ...dynamics.results import flags
from ...model.conversion import in_si
from ...model.names import keywords_checked
from ...model.quantities import with_error
from ..fitting.settings import CHOICES, check_choice
from ..kit import kept_attributes, labelled
from ..kit.least_squares import single_blas
from ..kit.noise import given_noise
from ..kit.regression import Line, weighted_line
from ..load_point.stress_steps import VARIABLE, stress_range
from ..messages import healing as sentences
from .holds import FEWEST, healing_record, noise_of_slides
from .measured import EVALUATED, FEWEST_OF_HOLD, NAMES, SHORT, STATUSES, measure
from .prediction import predict, sliders_of
from .steady import levels_of

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


@keywords_checked
def healing(data, *, slider=None, loading=None, trend="slip", noise=None):
    """Measure frictional healing and relaxation in each hold, and their rates per decade.

    The record is a slide-hold-slide test.  Healing is the peak of friction on reloading minus
    steady friction before the hold.  Relaxation is steady friction minus friction at the end of the
    hold.  Steady friction is a straight line, extrapolated to the time of the peak.  All slides
    share its slope.  The transient that remains from the previous hold is part of the fit.  The
    peak is taken from a fitted polynomial (generalized least squares), because the largest noisy
    sample is too high.

    Parameters
    ----------
    data : xarray.Dataset
        A record from `read_lab`, or a Dataset along ``time`` [s] with ``friction`` (else ``tau``
        with ``sigma`` [Pa], or ``mu``) and ``delta_lp`` [m] or ``V_load`` [m/s] of the load point.
    slider : SpringSlider or xarray.Dataset, optional
        Slider with which healing is predicted, or a result of `fit` under one or several laws,
        whose errors are then propagated.  For fits of each step the joint fit is used.
    loading : Loading, optional
        The load point's history, with t = 0 at the first sample.  By default the steps and holds
        are found in its displacement.
    trend : {"slip", "time", None}
        Whether friction drifts in proportion to slip of the fault, or to time, or not at all.
    noise : float or dict, optional
        Standard deviation of the noise in friction, or a dict with the standard deviations of its
        parts "white" and "red" and the correlation time "time" [s] of the red part.  By default it
        is estimated from the later halves of the slides, and never less than the resolution of
        friction.

    Returns
    -------
    xarray.Dataset
        Along ``hold``, in order of time:

        - ``hold_start`` and ``t_hold`` [s]: start and duration of the load point's rest.
        - ``V_before`` and ``V_after`` [m/s]: load-point speeds of the slides, NaN without a slide.
        - ``friction_before``: steady friction at the hold's start.
        - ``friction_min``: friction at the hold's end.
        - ``friction_peak`` and ``peak_time`` [s].
        - ``friction_after``: steady friction at the end of the slide after the hold.
        - ``delta_mu`` (healing) and ``delta_mu_c`` (relaxation).
        - ``hold_status`` (int8 with CF flags): 0 if healing is measured.  Otherwise
          ``delta_mu`` is NaN, and other values may be.
        - ``hold_message``: why a value is NaN, and remarks.

        Each friction, healing and relaxation has a standard error, ``NAME_error``.

        Scalars: ``beta`` and ``beta_c``, the change of healing and of relaxation per decade of hold
        time, with ``_error`` and ``_scatter``.  The scatter is the root of the reduced chi-square
        about the line, NaN with two holds.  If it is significantly above 1, the errors are enlarged
        by it.  The rates are NaN without two different hold times.  ``noise_white``,
        ``noise_red``, ``noise_time`` (0 without red noise).

        Along ``line``: ``line_t_hold`` [s], and the fitted lines with errors, ``line_delta_mu`` and
        ``line_delta_mu_c``.  Along ``time``: ``friction``, and ``friction_steady``, the line of
        steady friction from the slide before a hold to the peak.  It is NaN elsewhere.

        With a slider, along ``law`` and ``hold``: ``delta_mu_predicted`` and
        ``delta_mu_c_predicted``.  Along ``law``: ``beta_predicted`` and ``beta_c_predicted``, the
        slopes of lines through predictions with the same weights.  All have errors, which
        are 0 if the slider is not a fit.

    Raises
    ------
    ParameterError
        If the record cannot be used, has no hold, or has tau but no normal stress; if its slides
        are too short to estimate the noise; if the slider is a sweep, fits of steps have no joint
        fit, or a setting is out of range.

    Notes
    -----
    Healing is defined as in Dieterich (1972, doi:10.1029/JB077i020p03690) and Marone (1998,
    doi:10.1146/annurev.earth.26.1.643).  The rate is the slope of healing against log10 of hold
    time, by least squares weighted with the errors.  Slip of the fault is the load point's
    displacement minus friction/k, with k the slope of reloading.  If k is not resolved, slip is the
    load point's displacement.  No error is less than the rounding of friction.  ``hold_message``
    says if healing depends on the drift, or if a slide was too short to become steady.  The level
    of such a slide is taken from a line through all slides, with an error that includes their
    scatter.  If friction is not yet steady when a hold begins, its distance from steady friction
    is part of the errors.

    Examples
    --------
    >>> import numpy as np, ratestate as rs
    >>> slider = rs.SpringSlider(a=0.01, b=0.012, Dc="5 um", sigma="5 MPa", K="8 GPa/m")
    >>> loading = rs.Loading.steps("10 um/s", (20, 0), (30, "10 um/s"), (50, 0), (150, "10 um/s"))
    >>> run = rs.simulate(slider, loading, 170.0, times=np.linspace(0, 170, 3401))
    >>> noise = 1e-4 * np.random.default_rng(1).normal(size=3401)
    >>> record = run[["delta_lp"]].assign(friction=run.tau / slider.sigma + noise)
    >>> result = rs.healing(record, slider=slider)
    >>> result.delta_mu.values.round(3).tolist(), round(float(result.beta), 3)
    ([0.016, 0.03], 0.014)
    """
    check_choice("trend", trend, CHOICES["trend"])
    given, sliders = given_noise(noise), sliders_of(slider)
    record = healing_record(in_si(data), loading, trend)
    with single_blas():
        used = given or noise_of_slides(record)
        levels = levels_of(record, used)
        measured = [measure(record, hold, used, levels) for hold in record.holds]
    predicted = {
        law: [predict(fitted, hold, record.kind) for hold in record.holds]
        for law, fitted in sliders.items()
    }
    return dataset_of(record, used, measured, sliders, predicted).assign_attrs(
        title="ratestate healing",
        trend=str(trend),
        noise=json.dumps(noise),
        versions=versions(),
        **kept_attributes(data),
    )


def dataset_of(record, noise, measured, sliders, predicted):
    """Return the Dataset without attributes.

    measured : list of `MeasuredHold`
    sliders : law -> `Fitted`
    predicted : law -> list of the results of `predict`
    """
    holds, missing = record.holds, (np.nan, np.nan)
    t_hold = np.array([hold.duration for hold in holds])
    columns = {name: np.array([x.values.get(name, missing) for x in measured]).T for name in NAMES}
    quantities = {name: tuple(column) for name, column in columns.items()}
    messages = []
    for hold, result, *predictions in zip(holds, measured, *predicted.values(), strict=True):
        texts = [_message(record, hold, result), *(message for _, message in predictions)]
        messages.append("; ".join(filter(None, texts)))
    variables = labelled(
        "hold",
        hold_start=[hold.during.start for hold in holds],
        t_hold=t_hold,
        V_before=[hold.before.V for hold in holds],
        V_after=[hold.after.V for hold in holds],
        **quantities,
        peak_time=np.array([result.peak_time for result in measured]),
        hold_status=np.array([result.status for result in measured], np.int8),
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
    for hold, result in zip(record.holds, measured, strict=True):
        if result.status == EVALUATED:
            start = np.nanmin([result.before.start, hold.during.start])
            first, last = np.searchsorted(record.t, (start, result.peak_time))
            steady[first:last] = result.before.at(record.drift_coordinate[first:last])[0]
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
        for law, prediction in predicted.items():
            values = np.array([of_hold[i] for of_hold, _ in prediction])  # (holds, cases)
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
