"""The function `fit`: a slider's parameters and their errors from a record."""

import functools
import json
import warnings

from threadpoolctl import ThreadpoolController

from ...dynamics.results import provenance
from ...errors import FitWarning
from ...model.conversion import in_si
from ...model.names import keywords_checked
from .by_law import warnings_of
from .cycles.fit import fit_cycles
from .cycles.result import cycles_dataset
from .generalized_least_squares import least_squares_fit
from .likelihood.uncertainty import infer, with_posteriors
from .record import record_of
from .refusals import refusal
from .result import add_comparison, dataset_of, side_by_side
from .settings import checked_settings
from .unknowns import free_under

#: attributes of a record that its fit keeps
RECORD_ATTRIBUTES = ("source", "columns", "found", "notes")


@keywords_checked
def fit(
    data,
    slider,
    free=("a", "b", "Dc", "K"),
    law=None,
    *,
    against="time",
    loading=None,
    trend="slip",
    start="auto",
    noise=None,
    errors="auto",
):
    """Parameters of a slider from a laboratory record of friction, with honest errors.

    Weighted least squares between the record and the motion that eqs 1-4 give under the record's
    own loading, with inertia where the slider has it.  The weights are those of the noise's level
    and correlation, which are estimated from the residuals.

    Parameters
    ----------
    data : xarray.Dataset
        A record of `read_lab`; or, along ``time`` [s], ``friction`` (tau/sigma of the spring;
        else ``tau`` [Pa], or ``mu``, the friction of the interface) and ``delta_lp`` [m] or
        ``V_load`` [m/s], both of the load point.
    slider : SpringSlider
        The parameters that are not free (sigma always), and the search's initial guess of the free
        ones; one case.
    free : sequence of str
        Any of a, b, Dc, K, M, the parameters that the law has beside these, alpha where normal
        stress varies, and lag, the delay [s] of the load point's motion behind its record.  "mu0"
        may be among them, but every fit estimates it anyway.
    law : str, class or a sequence of these, optional
        Friction law; the slider's by default.  Several are fitted side by side: each has those of
        the slider's parameters, free or not, that belong to it, so the slider needs those of all.
    against : {"time", "displacement", "cycles"}
        Friction is compared at equal times, or at equal displacements of the load point (steps
        only), or, in a record of stick-slip or vibration, by the features of its cycles.
    loading : Loading, optional
        The load point's history, with t = 0 at the first sample; by default the steps and holds
        found in its displacement.  Normal stress varies if it does so here, or else in the
        variable ``sigma`` [Pa] of the record, by more than 1 % of its mean.
    trend : {"slip", "time", None}
        Whether friction also drifts in proportion to slip, or to time.
    start : {"auto", "steady", "free"}
        Whether the record begins in steady sliding at its first speed, or from a velocity and
        state that are estimated too; by default the latter where the record requires it.
    noise : float or dict, optional
        Standard deviation of the noise in friction; or those of its parts "white" and "red", and
        the correlation time "time" [s] of the red part.  Estimated by default.
    errors : {"auto", "covariance", "profile", "posterior"}
        Source of the intervals: the covariance at the best fit; profiles of the likelihood (take
        about 5 times as long as the fit, 20 times where one is open); samples of the posterior,
        by dynesty (some 7 s of one core for 10,000 evaluations, of which it takes 20,000 or more);
        "auto": the covariance, but a profile for each quantity along which the likelihood is not
        Gaussian.

    Returns
    -------
    xarray.Dataset
        A scalar under the name of each free parameter [SI], ``mu0``, ``a_minus_b`` and
        ``trend_slip`` [1/m] or ``trend_time`` [1/s]; if free, ``V_start``, ``theta_start`` and what
        other states the law has.  ``a_minus_b`` is d mu_ss/d ln V at the record's first speed:
        a - b, unless the law has more states or steady states of its own.  Along ``parameter``:
        ``standard_error`` and ``interval`` (``level`` 0.68 and 0.95, ``side``) [SI],
        ``interval_kind``, ``correlation`` (with ``other``; of the logarithms of what is positive).
        An open interval ends at inf or 0.  Along ``time``:
        ``friction``, ``friction_fit``, ``residual``, ``fit_error``, ``band`` (95 % of samples lie
        in it).  ``noise_white``, ``noise_red``, ``noise_time``, ``rms``, ``chi2_white``,
        ``log_likelihood``, ``aic``, ``bic``.  Profiles: ``profile_value`` [SI] and
        ``profile_deviance`` along ``profile_point``.  Posterior: ``posterior`` along ``sample``,
        all of the same weight, ``log_evidence`` and the sampler's diagnostics; the attribute
        ``prior``.  With several laws all this is in one Dataset along ``law``, with
        ``aic_difference``, ``akaike_weight``, ``log_bayes_factor`` and the attribute
        ``comparison``; what only some laws have is NaN or "" for the others.  The texts are
        ``warnings`` (a line each; "" if there are none) and ``identifiability``, a note on what is
        determined.

    Raises
    ------
    ParameterError
        A record without steps, too short, constant or with values missing; a parameter that
        cannot be free; a law that needs a parameter which the slider does not have; a setting out
        of range.  Against cycles a law with more than one state or length.

    Warns
    -----
    FitWarning
        A parameter is at a bound, the search has not converged, or the record does not determine
        a free parameter.

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
    settings = checked_settings(
        slider,
        free=free,
        law=law,
        noise=noise,
        against=against,
        trend=trend,
        start=start,
        errors=errors,
    )
    with single_blas():
        fits = _fits_of_cycles if against == "cycles" else _fits_of_samples
        results = fits(in_si(data), slider, settings, loading)
    kept = {name: data.attrs[name] for name in RECORD_ATTRIBUTES if name in data.attrs}
    names = json.dumps(settings.free)
    for name, result in results.items():
        origin = provenance("fit", slider, law=name, free=names, **settings.recorded)
        result.coords["law"] = name
        result.attrs = origin | result.attrs | kept
        prefix = f"{name} law: " if len(results) > 1 else ""
        for text in warnings_of(result):
            warnings.warn(prefix + text, FitWarning, stacklevel=3)
    alone = law is None or isinstance(law, str | type)
    return results[settings.laws[0]] if alone else side_by_side(results)


_thread_pools = functools.cache(ThreadpoolController)


def single_blas():
    """A context in which BLAS uses one thread: more spin longer than they work."""
    return _thread_pools().limit(limits=1, user_api="blas")


def _fits_of_cycles(data, slider, settings, loading):
    """law -> Dataset of a fit of cycles."""
    fits = {
        one.law: fit_cycles(data, one, settings.free, one.law, loading) for one in settings.sliders
    }
    results = {law: cycles_dataset(fit) for law, fit in fits.items()}
    if len(results) > 1:
        # errors that were enlarged for a misfit are so in the comparison as well
        scale = min(fit.enlarged for fit in fits.values()) ** 2
        add_comparison(results, {law: fit.chi2 / scale for law, fit in fits.items()})
    return results


def _fits_of_samples(data, slider, settings, loading):
    """law -> Dataset of a fit of friction, sample by sample."""
    free, sliders, noise, against, trend, start, errors = settings
    record = record_of(data, slider, loading=loading, trend=trend, against=against)
    if "alpha" in free and record.loading.normal_stress is None:
        raise refusal("free.constant_sigma")
    solutions = []
    for one in sliders:
        has = free_under([one.friction_law])
        of_law = tuple(name for name in free if name in has)
        solutions.append(least_squares_fit(record, one, of_law, noise, start))
    inferences = [infer(solution, noise, errors) for solution in solutions]
    if errors == "posterior":
        inferences = with_posteriors(inferences)
    datasets = [dataset_of(inference, data) for inference in inferences]
    results = dict(zip(settings.laws, datasets, strict=True))
    if len(results) > 1:
        colored = any(inference.solution.noise.red for inference in inferences)
        aic = {law: float(result["aic"]) for law, result in results.items()}
        add_comparison(results, aic, colored=colored)
    return results
