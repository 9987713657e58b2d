"""The function `fit`: a slider's parameters and their errors from a record."""

import json
import warnings

import xarray

from ...dynamics.results import provenance
from ...errors import FitWarning
from ...model.conversion import in_si
from ...model.names import keywords_checked
from ..kit import kept_attributes
from ..kit.least_squares import single_blas
from .by_law import warnings_of
from .cycles.fit_cycles import cycles_datasets
from .fit_dataset import datasets_of, joined, names_of, with_comparison
from .inference import inferences_of
from .settings import checked_settings
from .steps.experiment import fit_experiment
from .steps.step_table import warnings_of_steps


@keywords_checked
def fit(
    data,
    slider,
    free=("a", "b", "Dc", "K"),
    law=None,
    *,
    per_step=False,
    against="time",
    loading=None,
    trend="slip",
    start="auto",
    noise=None,
    errors="auto",
):
    """Estimate a slider's parameters and their errors from a laboratory record.

    Weighted least squares fit the record with the motion of eqs 1-4 under the record's loading,
    with inertia if the slider has mass.  The weights follow from the level and correlation of the
    noise, which are estimated from the residuals.

    Parameters
    ----------
    data : xarray.Dataset
        A record of `read_lab`; or, along ``time`` [s], ``friction`` (tau/sigma of the spring;
        else ``tau`` [Pa], or ``mu``, the friction of the interface) and ``delta_lp`` [m] or
        ``V_load`` [m/s], both of the load point.
    slider : SpringSlider
        The parameters that are not free (sigma never is), and the search's initial guess of the
        free ones.  It must be one slider, not a sweep.
    free : sequence of str
        Any of a, b, Dc, K, M, the law's additional parameters, alpha if normal stress varies, and
        lag, the delay [s] of the load point's motion behind its record.  "mu0" may be among them,
        but every fit estimates it anyway.
    law : str, class or a sequence of these, optional
        Friction law; the slider's by default.  Several laws are fitted side by side.  Each uses the
        slider's parameters, free or not, that belong to it.  So the slider needs the parameters of
        all laws.
    per_step : bool, default False
        Whether each velocity step, hold and step of normal stress in the record is fitted on its
        own window, on all cores.  The laws' parameters are also fitted to all steps together.
    against : {"time", "displacement", "cycles"}
        Friction is compared at equal times, or at equal displacements of the load point (steps
        only).  In a record of stick-slip or vibration, "cycles" compares features of the cycles.
    loading : Loading, optional
        The load point's history, with t = 0 at the first sample.  By default the steps and holds
        are found in its displacement.  Normal stress varies if it does so here, or else if the
        variable ``sigma`` [Pa] of the record varies by more than 1 % of its mean.
    trend : {"slip", "time", None}
        Whether friction also drifts in proportion to slip, or to time.
    start : {"auto", "steady", "free"}
        Whether the record begins in steady sliding at its first speed, or from a velocity and
        state that are also estimated.  By default they are estimated if the record requires it.
    noise : float or dict, optional
        Standard deviation of the noise in friction.  A dict gives one for each part, "white" and
        "red", and the correlation time "time" [s] of the red part.  By default the noise is
        estimated as white noise.  A red part is added if the record shows it, with one correlation
        time or with a spectrum that is a power of frequency.
    errors : {"auto", "covariance", "profile", "posterior"}
        Source of the intervals: the covariance at the best fit; profiles of the likelihood, which
        take about 5 times as long as the fit, or 20 times if one is open; samples of the posterior,
        by dynesty, which needs 20,000 evaluations or more, at about 7 s of one core for 10,000.
        "auto": the covariance, but a profile for each quantity along which the likelihood is not
        Gaussian.

    Returns
    -------
    xarray.Dataset
        A scalar under the name of each free parameter [SI], ``mu0``, ``a_minus_b`` and
        ``trend_slip`` [1/m] or ``trend_time`` [1/s]; if the start is free, ``V_start``,
        ``theta_start`` and the law's other states.  ``a_minus_b`` is d mu_ss/d ln V at the record's
        first speed.  It equals a - b, unless the law has more states or another steady state.
        Along ``parameter``: ``standard_error`` and ``interval`` (``level`` 0.68 and 0.95, ``side``)
        [SI], ``interval_kind``, ``correlation`` (with ``other``; of the logarithms of positive
        parameters), and ``without_trend``, the estimates without the trend, to first order.
        An open interval ends at inf or 0.  Along ``time``:
        ``friction``, ``friction_fit``, ``residual``, ``fit_error``, ``band`` (95 % of samples lie
        in it).  ``noise_white``, ``noise_red``, ``noise_time``, ``noise_exponent`` (1 is 1/f noise,
        0 noise of one correlation time), ``rms``, ``chi2_white``, ``log_likelihood``, ``aic``,
        ``bic``; ``misfit_p_value``, the probability that noise alone leaves the transients that the
        residuals have after the steps, or NaN if it was not tested.  Profiles: ``profile_value``
        [SI] and ``profile_deviance`` along ``profile_point``.  Posterior: ``posterior`` along
        ``sample``, with equal weights, ``log_evidence`` and the sampler's diagnostics; the
        attribute ``prior``.  With several laws all this is in one Dataset along ``law``, with
        ``aic_difference``, ``akaike_weight``, ``log_bayes_factor`` and the attribute
        ``comparison``.  Variables that only some laws have are NaN or "" for the others.  The texts
        are ``warnings`` (one on each line; "" if there are none) and ``identifiability``, a note on
        which parameters are determined.

        With per_step=True parameters, errors, statistics and texts are along ``step``, 1 to n in
        order of time (and along ``law`` if there are several).  They are NaN and "" if ``status``
        is 1 (failed) or 2 (stick-slip, which is not fitted); ``message`` says why.  Along ``step``
        alone: ``kind`` ("step", "hold" or "normal stress"), its place ``step_t`` [s] and
        ``step_delta_lp`` [m], ``V_before`` and ``V_after`` [m/s], ``t_hold`` [s], ``sigma`` and,
        after a step of normal stress, ``sigma_after`` [Pa], ``samples``, each the mean of
        ``rows_per_sample`` rows (1 if the window has at most 20,000 rows).  A thinned record and
        fitted curve are along ``sample``.  Along ``parameter``: ``shared``, the estimate of one set
        for all steps and holds, ``shared_error`` and, with ``other``, ``shared_correlation``;
        ``scatter``, the standard deviation between steps beyond their errors; ``up_over_down``, the
        mean over steps up divided by the mean over steps down, with its error and the p-value of
        Student's test.  ``shared_p_value`` is the probability of as large a ``shared_deviance`` if
        one set serves all steps.  At a step of normal stress only alpha is free; a, b, Dc and K are
        held at the estimates from the other steps.

    Raises
    ------
    ParameterError
        A record without steps, too short, constant or with missing values; a parameter that
        cannot be free; a law with a parameter that the slider lacks; a setting out of range.
        Against cycles: a law with more than one state or length.  With per_step=True: no step that
        can be fitted; a loading; against cycles.

    Warns
    -----
    FitWarning
        A parameter is at a bound, the search has not converged, the record does not determine
        a free parameter, the law does not describe the record, or the estimates depend on a trend
        that friction before the first step does not confirm.  With per_step=True: the posterior of
        a step failed.

    Examples
    --------
    >>> import numpy as np, ratestate as rs
    >>> slider = rs.SpringSlider(a=0.01, b=0.012, Dc="10 um", sigma="5 MPa", K="5 GPa/m")
    >>> step = rs.Loading.steps("1 um/s", (100.0, "10 um/s"))
    >>> run = rs.simulate(slider, step, 140.0, times=np.linspace(0, 140, 1401))
    >>> noise = 1e-4 * np.random.default_rng(1).normal(size=1401)
    >>> record = run[["delta_lp"]].assign(friction=run.tau / slider.sigma + noise)
    >>> result = rs.fit(record, slider.replace(a=0.005, b=0.005, Dc="30 um"))
    >>> round(float(result.Dc), 7)
    1e-05
    """
    choices = {"against": against, "trend": trend, "start": start, "errors": errors}
    settings = checked_settings(
        slider, free=free, law=law, noise=noise, per_step=per_step, loading=loading, **choices
    )
    record = in_si(data)
    with single_blas():
        if per_step:
            laws = settings.laws
            results = {laws[0] if len(laws) == 1 else None: fit_experiment(record, settings)}
        elif against == "cycles":
            results, criterion, fits = cycles_datasets(record, settings, loading)
        else:
            inferences = inferences_of(record, settings, loading)
            results, criterion, fits = datasets_of(inferences, settings.laws, record)
    more = {
        "free": json.dumps(settings.free),
        "per_step": int(per_step) or None,
        **{name: str(value) for name, value in choices.items()},
    }
    for name, result in results.items():
        origin = provenance("fit", slider, law=name, **more)
        result.attrs = origin | result.attrs | kept_attributes(data)
        prefix = f"{name} law: " if len(results) > 1 else ""
        for text in warnings_of(result) if not per_step else warnings_of_steps(result):
            warnings.warn(prefix + text, FitWarning, stacklevel=3)
    if per_step:
        return result
    results = {name: result.assign_coords(law=name) for name, result in results.items()}
    if law is None or isinstance(law, str | type):
        return results[settings.laws[0]]
    result = joined(results.values(), "law", names_of(results.values(), results))
    if len(results) > 1:
        result = with_comparison(result, xarray.DataArray(criterion, dims="law"), fits)
    return result
