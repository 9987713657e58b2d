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

    The motion of eqs 1-4 under the record's loading is fitted by weighted least squares.  It has
    inertia if the slider has mass.  The weights follow from the level and correlation of the noise,
    which are estimated from the residuals.

    Parameters
    ----------
    data : xarray.Dataset
        A record from `read_lab`, or a Dataset along ``time`` [s].  It needs ``friction`` (tau/sigma
        of the spring), ``tau`` [Pa] or ``mu`` (friction of the interface).  It also needs
        ``delta_lp`` [m] or ``V_load`` [m/s] of the load point.
    slider : SpringSlider
        Its values of free parameters are the initial guess of the search.  All other parameters
        stay at its values, always including sigma.  It must be one slider, not a sweep.
    free : sequence of str
        Parameters to estimate: any of a, b, Dc, K, M, the law's additional parameters, alpha if
        normal stress varies, and lag, the delay [s] of the load point's motion behind its record.
        "mu0" is allowed, but every fit estimates it anyway.
    law : str, class or a sequence of these, optional
        Friction law.  By default the slider's law is used.  Several laws are fitted side by side.
        The slider needs the parameters of all of them.  Each law ignores parameters that it does
        not have.
    per_step : bool, default False
        Whether each velocity step, hold and step of normal stress in the record is fitted on its
        own window, on all cores.  The laws' parameters are also fitted to all steps together.
    against : {"time", "displacement", "cycles"}
        Friction is compared at equal times, or at equal displacements of the load point (not for
        holds).  In a record of stick-slip or vibration, "cycles" compares features of the cycles.
    loading : Loading, optional
        The load point's history, with t = 0 at the first sample.  By default the steps and holds
        are found in its displacement.  The model's normal stress is taken from this loading if it
        varies there.  Otherwise it is taken from the record's ``sigma`` [Pa], if that changes by
        more than 1 % of its mean.
    trend : {"slip", "time", None}
        Whether friction also drifts in proportion to slip, or to time, or not at all.
    start : {"auto", "steady", "free"}
        Whether the record begins in steady sliding at its first speed, or from a velocity and
        state that are also estimated.  By default they are estimated if the record requires it.
    noise : float or dict, optional
        Standard deviation of the noise in friction.  A dict gives one for each part, "white" and
        "red", and the correlation time "time" [s] of the red part.  By default the noise is
        estimated as white noise.  A red part is added if the record shows it.  It has one
        correlation time, or a spectrum proportional to a power of frequency.
    errors : {"auto", "covariance", "profile", "posterior"}
        Source of the intervals.  "covariance": the covariance at the best fit.  "profile": profiles
        of the likelihood, which take about 5 times as long as the fit, or 20 times if an interval
        is open.  "posterior": samples of the posterior by dynesty, which needs 20,000 evaluations
        or more.  10,000 evaluations take about 7 s on one core.  "auto": the covariance, but a
        profile for each quantity along which the likelihood is not Gaussian.

    Returns
    -------
    xarray.Dataset
        Scalars, in SI:

        - each free parameter, under its name, and ``mu0``.
        - ``a_minus_b``, if a free parameter changes it: d mu_ss/d ln V at the record's first speed.
          It equals a - b, unless the law has more states or another steady state.
        - ``trend_slip`` [1/m] or ``trend_time`` [1/s]; neither if trend is None.
        - ``V_start``, ``theta_start`` and the law's other states, if the start is free.
        - ``noise_white``, ``noise_red``, ``noise_time`` and ``noise_exponent`` (1 is 1/f noise, 0
          is noise with one correlation time).
        - ``rms``, ``chi2_white``, ``log_likelihood``, ``aic``, ``bic``, ``samples`` and
          ``evaluations``.
        - ``misfit_p_value``: probability that noise alone causes such transients in the residuals
          after steps; NaN if it was not tested.
        - ``warnings``: one on each line, or "".
        - ``identifiability``: a note on which parameters are determined.

        Along ``parameter`` (free parameters, ``mu0``, ``a_minus_b`` and the trend):

        - ``standard_error`` and ``interval`` (``level`` 0.68 and 0.95, ``side``) [SI].  An open
          interval ends at inf or 0.
        - ``interval_kind``: source of the interval.
        - ``correlation`` (with ``other``), taken of the logarithms of positive parameters.
        - ``without_trend``: estimates without the trend, to first order, if there is one.
        - ``profile_value`` [SI] and ``profile_deviance`` along ``profile_point``, for profiles.
        - ``posterior`` along ``sample``, with equal weights, for a posterior.  The result then also
          has ``log_evidence``, diagnostics of the sampler and the attribute ``prior``.

        Along ``time``: ``delta_lp``, ``friction``, ``friction_fit``, ``residual``, ``fit_error``
        and ``band`` (also along ``side``), in which 95 % of samples lie.

        A sequence of laws gives one Dataset along ``law``.  For several laws it also has
        ``aic_difference``, ``bic_difference``, ``akaike_weight`` and the attribute ``comparison``,
        and ``log_bayes_factor`` for posteriors.  Variables that only some laws have are NaN or ""
        for the others.

        With per_step=True, parameters, errors, statistics and texts are along ``step``, 1 to n in
        order of time.  They are NaN or "" if ``status`` is 1 (failed) or 2 (stick-slip, which is
        not fitted).  ``message`` says why.  At a step of normal stress only alpha is free.  a, b,
        Dc and K have the estimates from the other steps.  There are also, along ``step``:

        - ``kind``: "step", "hold" or "normal stress".
        - ``step_t`` [s] and ``step_delta_lp`` [m]: its time and displacement.
        - ``V_before`` and ``V_after`` [m/s]; ``t_hold`` [s].
        - ``sigma`` [Pa], and ``sigma_after`` [Pa] after a step of normal stress.
        - ``samples``: number of samples.  Each is the mean of ``rows_per_sample`` rows, which is 1
          if the window has at most 20,000 rows.
        - ``time``, ``delta_lp``, ``friction`` and ``friction_fit``, thinned, also along ``sample``.

        Also along ``parameter``:

        - ``shared`` and ``shared_error``: estimate and error of one set for all steps and holds,
          NaN for K, mu0 and others that are not the law's; ``shared_correlation`` (with ``other``).
        - ``scatter``: standard deviation between steps that their errors do not explain.
        - ``up_over_down``: mean over steps up divided by mean over steps down, with
          ``up_over_down_error`` and ``up_over_down_p_value`` of Student's test.

        ``shared_deviance`` is chi-square of one set for all steps minus chi-square of separate
        sets.  ``shared_degrees`` is the number of parameters saved.  ``shared_p_value`` is the
        probability of such a deviance or a larger one, if one set describes all steps.  All of
        these are NaN if there are too few steps.

    Raises
    ------
    ParameterError
        If the record has no steps, is too short or constant, or has missing values; if a parameter
        cannot be free; if the slider lacks a parameter of a law; if a setting is out of range.
        Against cycles: if a law has more than one state or length.  With per_step=True: if no step
        can be fitted, a loading is given, or the fit is against cycles.

    Warns
    -----
    FitWarning
        If a parameter is at a bound, the search has not converged, the record does not determine a
        free parameter, the law does not describe the record, or the estimates depend on a trend
        that is not seen in friction before the first step.  With per_step=True: also if the
        posterior of a step failed.

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
