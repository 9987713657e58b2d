"""The function `healing`: frictional healing of the holds of a record, and its rate."""

import json

from ...dynamics.results import versions
from ...model.conversion import in_si
from ...model.names import keywords_checked
from ..fitting.settings import CHOICES, check_choice
from ..kit.least_squares import single_blas
from ..kit.noise import given_noise
from ..kit.results import kept_attributes
from .measured import measure
from .prediction import predict, sliders_of
from .record import healing_record, noise_of_slides
from .result import dataset_of
from .steady import levels_of


@keywords_checked
def healing(data, slider=None, *, loading=None, trend="slip", noise=None):
    """Frictional healing and relaxation of each hold of a record, and their rates per decade.

    A slide-hold-slide test: healing is the peak of friction on reloading above steady friction
    before the hold, relaxation the fall of friction below it during the hold.  Steady friction is
    a line that is extrapolated to the peak.  Its slope is common to all slides, and what is left
    of the transient after the previous hold is allowed for.  The peak is that of a polynomial
    fitted about it by generalized least squares, because the largest of noisy samples is too high.

    Parameters
    ----------
    data : xarray.Dataset
        A record of `read_lab`; or, along ``time`` [s], ``friction`` (else ``tau`` with ``sigma``
        [Pa], or ``mu``) and ``delta_lp`` [m] or ``V_load`` [m/s] of the load point.
    slider : SpringSlider or xarray.Dataset, optional
        What holds are to be predicted of: one slider, or a result of `fit`, under one law or
        several, with its errors; of fits of each step the joint fit.
    loading : Loading, optional
        The load point's history, with t = 0 at the first sample; by default the steps and holds
        found in its displacement.
    trend : {"slip", "time", None}
        Whether friction drifts in proportion to slip of the fault, or to time, or not at all.
    noise : float or dict, optional
        Standard deviation of the noise in friction; or those of its parts "white" and "red", and
        the correlation time "time" [s] of the red part.  By default estimated, from the later
        halves of the slides, and at least the resolution of friction.

    Returns
    -------
    xarray.Dataset
        Along ``hold``, n holds in order of time: ``hold_start`` [s], ``t_hold`` [s], how long
        the load point rests, ``V_before`` and ``V_after`` [m/s], ``friction_before`` (steady, at
        the hold's start), ``friction_min`` (at its end), ``friction_peak``, ``peak_time`` [s],
        ``friction_after`` (steady, at the end of the slide after), ``delta_mu``
        (healing) and ``delta_mu_c`` (relaxation); each friction with its standard error,
        ``NAME_error``.  ``hold_status`` (int8 with CF flags; 0 evaluated) and ``hold_message``
        (why something is NaN, or must be known).  Scalars: ``beta`` and ``beta_c``, change of
        healing and of relaxation per decade of hold time, with ``_error``, and ``_scatter``, the
        root of the reduced chi-square about the line: where it is significantly above 1 the
        errors are enlarged by it.  NaN without two different hold times.  Along ``line``:
        ``line_t_hold``, and the lines with errors, ``line_delta_mu`` and ``line_delta_mu_c``.
        With a slider, along
        ``law`` and ``hold``: ``delta_mu_predicted``, ``delta_mu_c_predicted``, and along ``law``
        ``beta_predicted`` and ``beta_c_predicted``, slopes of the same weighted line through
        predictions; with standard errors where they are from a fit.  ``noise_white``,
        ``noise_red``, ``noise_time``.  Along ``time``: ``friction``, and ``friction_steady``, the
        line of steady friction from the slide before a hold to the peak, NaN elsewhere.

    Raises
    ------
    ParameterError
        A record that cannot be used, as of `fit`; none with a hold; slides too short for the noise
        to be estimated; a slider that is a sweep; fits of steps without a joint fit; a setting out
        of range.

    Notes
    -----
    Healing as of Dieterich (1972, doi:10.1029/JB077i020p03690) and Marone (1998,
    doi:10.1146/annurev.earth.26.1.643).  The rate is that of healing with log10 of hold time, by
    least squares weighted with the errors.  Slip of the fault is the load point's displacement less
    friction/k, with k the slope of reloading; the load point's displacement if k is not resolved.
    No error is less than the rounding of friction.  ``hold_message`` says when healing depends on
    the drift, and when a slide was too short to become steady.  Its level is then that of a line
    through all slides, from which slides differ by as much as they are seen to.

    Examples
    --------
    >>> import numpy as np, ratestate as rs
    >>> slider = rs.SpringSlider(a=0.01, b=0.012, Dc="5 um", sigma="5 MPa", K="8 GPa/m")
    >>> loading = rs.Loading.steps("10 um/s", (20, 0), (30, "10 um/s"), (50, 0), (150, "10 um/s"))
    >>> run = rs.simulate(slider, loading, 170.0, times=np.linspace(0, 170, 3401))
    >>> noise = 1e-4 * np.random.default_rng(1).normal(size=3401)
    >>> record = run[["delta_lp"]].assign(friction=run.tau / slider.sigma + noise)
    >>> result = rs.healing(record, slider)
    >>> result.delta_mu.values.round(3).tolist(), round(float(result.beta), 3)
    ([0.016, 0.03], 0.014)
    """
    check_choice("trend", trend, CHOICES["trend"])
    given, sliders = given_noise(noise), sliders_of(slider)
    record = healing_record(in_si(data), loading, trend)
    with single_blas():
        found = given or noise_of_slides(record)
        levels = levels_of(record, found)
        measured = [measure(record, hold, found, levels) for hold in record.holds]
    predicted = {
        law: [predict(fitted, hold, record.kind) for hold in record.holds]
        for law, fitted in sliders.items()
    }
    return dataset_of(record, found, measured, sliders, predicted).assign_attrs(
        title="ratestate healing",
        trend=str(trend),
        noise=json.dumps(noise),
        versions=versions(),
        **kept_attributes(data),
    )
