"""The verb `fit`: a record and a slider; out come its parameters, with their errors."""

import json
import warnings

import numpy as np
import xarray

from ..dataset import provenance, record_loading
from ..errors import FitWarning, ParameterError
from ..laws import evolution_law
from ..slider import checked
from ..units import is_array
from .blas import single_blas
from .identify import identified
from .noise import given_noise
from .record import record_of
from .result import curves, estimate_variables, estimates, statistics
from .solve import solve
from .unknowns import checked_free

CHOICES = {
    "against": ("time", "displacement", "cycles"),
    "trend": ("slip", "time", None),
    "start": ("auto", "steady", "free"),
}


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
        than its record says.  mu0 is always found.
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

    Returns
    -------
    xarray.Dataset
        A scalar under the name of each free parameter [SI], ``mu0`` and ``a_minus_b``.  Along
        ``parameter``: ``standard_error`` and ``interval`` (``level`` 0.68 and 0.95, ``side``)
        [SI], ``correlation`` (with ``other``; of the logarithms, but for b).  Along ``time``:
        ``friction``, ``friction_fit``, ``residual``, ``fit_error``, ``band`` (95 % of samples lie
        in it).  ``noise_white``, ``noise_red``, ``noise_time``, ``rms``, ``chi2_white``,
        ``log_likelihood``, ``aic``, ``bic``.  Several laws lie along ``law``.  The attributes
        ``warnings`` (JSON) and ``identifiability`` say in words what the numbers cannot.

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
    _checked_choices(against=against, trend=trend, start=start)
    noise = given_noise(noise)
    laws = [slider.law] if law is None else [law] if isinstance(law, str) else list(law)
    record = record_of(data, slider, loading=loading, trend=trend, against=against)
    settings = {"against": against, "trend": str(trend), "start": start}
    with single_blas():
        found = [_fit_one(record, slider, one, free, noise, settings) for one in laws]
    for result in found:
        for text in json.loads(result.attrs["warnings"]):
            warnings.warn(text, FitWarning, stacklevel=2)
    return found[0] if law is None or isinstance(law, str) else _side_by_side(found, laws)


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


def _fit_one(record, slider, law, free, noise, settings):
    """The result under one law."""
    solution = solve(record, slider, evolution_law(law).code, free, noise, settings["start"])
    names = solution.unknowns.reported
    derived = _derived(solution, slider)
    which = [solution.unknowns.index(name) for name in (*names, "level")]
    spread = solution.covariance[np.ix_(which, which)]
    found = estimates((*names, "level"), solution.point[which], spread, derived).without("level")
    result = xarray.merge([estimate_variables(found), curves(solution), statistics(solution)])
    words, problems = identified(solution, found)
    result.attrs = provenance(
        "fit", slider, law=law, free=json.dumps(free), **settings, identifiability=words
    )
    result.attrs["warnings"] = json.dumps(problems)
    record_loading(result, record.loading)
    return result


def _derived(solution, slider):
    """mu0 and a - b, as (symbol, value, gradient) by the reported coordinates and the level."""
    names = (*solution.unknowns.reported, "level")
    value = {name: solution.point[solution.unknowns.index(name)] for name in names}
    a = np.exp(value["a"]) if "a" in names else slider.a
    b = value.get("b", slider.b)
    by = np.array([{"a": a, "b": -1.0}.get(name, 0.0) for name in names])
    height = np.log(solution.problem.forward.V0 / slider.V0)
    level = np.array([name == "level" for name in names], float)
    mu0 = ("mu0", value["level"] - (a - b) * height, level - height * by)
    return [mu0, ("a_minus_b", a - b, by)] if by.any() else [mu0]


def _side_by_side(found, laws):
    """Results under several laws as one, along ``law``."""
    joined = xarray.concat(
        found, xarray.Variable("law", laws), join="outer", combine_attrs="drop_conflicts"
    )
    for name in ("warnings", "identifiability"):
        each = {law: result.attrs[name] for law, result in zip(laws, found, strict=True)}
        joined.attrs[name] = json.dumps(each)
    return joined
