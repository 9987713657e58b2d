"""The verb `fit`: a record and a slider; out come its parameters, with their errors."""

import json
import warnings

from ...dynamics.results import provenance
from ...errors import FitWarning, ParameterError
from ...friction.laws import evolution_law
from ...model.slider import checked
from ...model.units import is_array
from .answer import add_comparison, result_of, side_by_side
from .blas import single_blas
from .cycles.fit import fit_cycles
from .cycles.result import cycles_dataset
from .each import warnings_of
from .likelihood.uncertainty import ERRORS, uncertain, with_posteriors
from .noise import given_noise
from .record import record_of
from .solve import solve
from .unknowns import checked_free

CHOICES = {
    "against": ("time", "displacement", "cycles"),
    "trend": ("slip", "time", None),
    "start": ("auto", "steady", "free"),
    "errors": ERRORS,
}
#: attributes of a record that its fit keeps
CARRIED = ("source", "columns", "found", "notes")


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
        What is not free (sigma among it), and where the search for the rest begins; one case.
    free : sequence of str
        Any of a, b, Dc, K, M and lag, the time [s] by which the load point's motion comes later
        than its record says.  "mu0" may be among them, but every fit finds it anyway.
    law : {"slip", "aging"} or a sequence of both, optional
        Evolution law; the slider's by default.  Several are fitted side by side.
    against : {"time", "displacement", "cycles"}
        Friction is compared at equal times, or at equal displacements of the load point (steps
        only), or, in a record of stick-slip or vibration, by the features of its cycles.
    loading : Loading, optional
        What the load point did, t = 0 being the first sample; by default the steps and holds that
        are found in its displacement.
    trend : {"slip", "time", None}
        Whether friction also drifts in proportion to slip, or to time.
    start : {"auto", "steady", "free"}
        Whether the record begins in steady sliding at its first speed, or from a velocity and
        state to be found; by default the latter where the record says so.
    noise : float or dict, optional
        Standard deviation of the noise in friction; or its parts "white" and "red" and the
        correlation time "time" [s] of the latter.  Estimated by default.
    errors : {"auto", "covariance", "profile", "posterior"}
        What the intervals are from: the covariance at the best fit; profiles of the likelihood
        (about 5 times as long as the fit, 20 times where one has no end); samples of the posterior,
        by dynesty (some 7 s of one core for 10,000 evaluations, of which it takes 20,000 or more);
        "auto": the covariance, but a profile for each number along which the likelihood is not
        Gaussian.

    Returns
    -------
    xarray.Dataset
        A scalar under the name of each free parameter [SI], ``mu0``, ``a_minus_b`` and
        ``trend_slip`` [1/m] or ``trend_time`` [1/s]; ``V_start`` and ``theta_start`` if found.
        Along ``parameter``: ``standard_error`` and ``interval`` (``level`` 0.68 and 0.95, ``side``)
        [SI], ``interval_kind``, ``correlation`` (with ``other``; of the logarithms, but for b).
        An interval that the record does not close ends at inf or 0.  Along ``time``:
        ``friction``, ``friction_fit``, ``residual``, ``fit_error``, ``band`` (95 % of samples lie
        in it).  ``noise_white``, ``noise_red``, ``noise_time``, ``rms``, ``chi2_white``,
        ``log_likelihood``, ``aic``, ``bic``.  Profiles: ``profile_value`` [SI] and
        ``profile_deviance`` along ``profile_point``.  Posterior: ``posterior`` along ``sample``,
        all of the same weight, ``log_evidence`` and the sampler's diagnostics; the attribute
        ``prior``.  Several laws lie along ``law``, with ``aic_difference``, ``akaike_weight``,
        ``log_bayes_factor`` and the attribute ``comparison``.  The texts ``warnings`` (a line
        each; "" if all is well) and ``identifiability`` say what the numbers cannot.

    Raises
    ------
    ParameterError
        A record without steps, too short, constant or with values missing; a parameter that
        cannot be free; a setting out of range.

    Warns
    -----
    FitWarning
        A parameter has run to a bound, the search has not converged, or the record does not
        determine what was asked of it.

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
    _checked_slider(slider)
    free = checked_free(free, slider)
    _checked_choices(against=against, trend=trend, start=start, errors=errors)
    noise = given_noise(noise)
    laws = _checked_laws(law, slider)
    settings = {"against": against, "trend": str(trend), "start": start, "errors": errors}
    with single_blas():
        if against == "cycles":
            _checked_for_cycles(**settings, noise=noise)
            results = _against_cycles(data, slider, free, laws, loading)
        else:
            record = record_of(data, slider, loading=loading, trend=trend, against=against)
            sought = [
                solve(record, slider, evolution_law(one).code, free, noise, start) for one in laws
            ]
            results = _against_samples(data, slider, sought, laws, noise, errors)
    carried = {name: data.attrs[name] for name in CARRIED if name in data.attrs}
    for one, result in results.items():
        made = provenance("fit", slider, law=one, free=json.dumps(free), **settings)
        result.coords["law"] = one
        result.attrs = made | result.attrs | carried
        about = f"{one} law: " if len(laws) > 1 else ""
        for text in warnings_of(result):
            warnings.warn(about + text, FitWarning, stacklevel=2)
    return results[laws[0]] if law is None or isinstance(law, str) else side_by_side(results)


def _checked_slider(slider):
    checked(slider)
    for symbol, value in slider.values.items():
        if is_array(value):
            raise ParameterError(
                f"{symbol} of the slider is a DataArray; a fit starts from one slider: give one "
                f"value"
            )


def _checked_choices(**given):
    for name, value in given.items():
        if not (value is None or isinstance(value, str)) or value not in CHOICES[name]:
            listed = ", ".join(map(repr, CHOICES[name]))
            raise ParameterError(f"{name} = {value!r} is unknown; choose one of {listed}")


def _checked_laws(law, slider):
    """The laws as a list, each of them once."""
    laws = [slider.law] if law is None else [law] if isinstance(law, str) else list(law)
    for one in laws:
        evolution_law(one)
    if not laws or len(set(laws)) < len(laws):
        raise ParameterError(f"law = {law!r} must name one law, or several that differ")
    return laws


def _checked_for_cycles(*, against, trend, start, errors, noise):
    """Refuse what only a fit against time knows."""
    given = {
        "trend": trend != "slip",
        "start": start != "auto",
        "errors": errors != "auto",
        "noise": noise is not None,
    }
    if any(given.values()):
        listed = ", ".join(name for name, on in given.items() if on)
        raise ParameterError(
            f"{listed}: a fit against={against!r} has no such choice: it removes the trend from "
            f"cycle to cycle and takes the noise from what they differ by; leave it out"
        )


def _against_cycles(data, slider, free, laws, loading):
    """law -> the result of a fit of cycles."""
    fits = {one: fit_cycles(data, slider, free, one, loading) for one in laws}
    results = {one: cycles_dataset(found) for one, found in fits.items()}
    if len(laws) > 1:
        # errors that were enlarged for a misfit count so in the comparison as well
        scale = min(found.enlarged for found in fits.values()) ** 2
        add_comparison(results, {one: found.chi2 / scale for one, found in fits.items()})
    return results


def _against_samples(data, slider, sought, laws, noise, errors):
    """law -> the result of a fit of friction, from its `Solution`."""
    known = [uncertain(one, slider, noise, errors) for one in sought]
    if errors == "posterior":
        known = with_posteriors(known, laws)
    results = {law: result_of(one, data, slider) for law, one in zip(laws, known, strict=True)}
    if len(laws) > 1:
        colored = any(one.solution.noise.red for one in known)
        aic = {law: float(one["aic"]) for law, one in results.items()}
        add_comparison(results, aic, colored=colored)
    return results
