"""The function `healing`: frictional healing in the holds of a record, and its rate."""

import json

from ...dynamics.recipe import versions
from ...model.conversion import in_si
from ...model.names import keywords_checked
from ..fitting.settings import CHOICES, check_choice
from ..kit.least_squares import single_blas
from ..kit.noise import given_noise
from ..kit.results import kept_attributes
from .holds import healing_record, noise_of_slides
from .measured import measure
from .prediction import predict, sliders_of
from .rates import dataset_of
from .steady import levels_of


@keywords_checked
def healing(data, *, slider=None, loading=None, trend="slip", noise=None):
    """Measure frictional healing and relaxation in each hold, and their rates per decade.

    The record is a slide-hold-slide test.  Healing is the peak of friction on reloading minus
    steady friction before the hold.  Relaxation is steady friction minus friction at the end of the
    hold.  Steady friction is a straight line, extrapolated to the time of the peak; all slides
    share its slope.  The rest of the transient after the previous hold is modelled.  The peak is
    taken from a fitted polynomial (generalized least squares), because the largest noisy sample is
    too high.

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
        - ``V_before`` and ``V_after`` [m/s]: load-point speeds of the slides.
        - ``friction_before``: steady friction at the hold's start.
        - ``friction_min``: friction at the hold's end.
        - ``friction_peak`` and ``peak_time`` [s].
        - ``friction_after``: steady friction at the end of the slide after the hold.
        - ``delta_mu`` (healing) and ``delta_mu_c`` (relaxation).
        - ``hold_status`` (int8 with CF flags): 0 if the hold is evaluated.
        - ``hold_message``: why a value is NaN, and remarks.

        Each friction, healing and relaxation has a standard error, ``NAME_error``.

        Scalars: ``beta`` and ``beta_c``, the change of healing and of relaxation per decade of hold
        time, with ``_error`` and ``_scatter``.  The scatter is the root of the reduced chi-square
        about the line.  If it is significantly above 1, the errors are enlarged by it.  The rates
        are NaN without two different hold times.  ``noise_white``, ``noise_red``, ``noise_time``.

        Along ``line``: ``line_t_hold``, and the lines with errors, ``line_delta_mu`` and
        ``line_delta_mu_c``.  Along ``time``: ``friction``, and ``friction_steady``, the line of
        steady friction from the slide before a hold to the peak, NaN elsewhere.

        With a slider, along ``law`` and ``hold``: ``delta_mu_predicted`` and
        ``delta_mu_c_predicted``.  Along ``law``: ``beta_predicted`` and ``beta_c_predicted``, the
        slopes of lines through predictions with the same weights.  All have errors if the slider
        is a fit.

    Raises
    ------
    ParameterError
        If the record cannot be used or has no hold, its slides are too short to estimate the noise,
        the slider is a sweep, fits of steps have no joint fit, or a setting is out of range.

    Notes
    -----
    Healing is defined as by Dieterich (1972, doi:10.1029/JB077i020p03690) and Marone (1998,
    doi:10.1146/annurev.earth.26.1.643).  The rate is the slope of healing against log10 of hold
    time, by least squares weighted with the errors.  Slip of the fault is the load point's
    displacement minus friction/k, with k the slope of reloading.  If k is not resolved, slip is the
    load point's displacement.  No error is less than the rounding of friction.  ``hold_message``
    says if healing depends on the drift, or if a slide was too short to become steady.  The level
    of such a slide is taken from a line through all slides, with an error that includes their
    scatter.

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
