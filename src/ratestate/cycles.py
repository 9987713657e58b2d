"""The verb `limit_cycle`: what a steadily driven slider settles into."""

import json

import numpy as np
import xarray

from .batch import Batch
from .cases import engine_cases, failure, run_cases, speed
from .dataset import plain, provenance, status_variable
from .engine.model import NO_CONVERGENCE, NUMBERS, SEEK, STEADY_SLIDING, Loads
from .errors import ParameterError
from .laws import evolution_law
from .progress import bar
from .quantities import attrs
from .slider import checked
from .stability import K_c, eta
from .start import initial_state
from .units import is_array, to_si

TAKEN = "period frequency amplitude V_max V_min inertia status".split()
# The march must be finer than what is asked of the cycle, which sums its errors.
MARCH_RTOL = 0.1
# Steps after which cycles that still change count as not settling; where eta is large they
# settle over some eta of them.
MAX_STEPS = 4e6
MOST_STEPS = 4e7


def limit_cycle(slider, V_lp, *, rtol=1e-8):
    """The cycle that a slider reaches from steady sliding at V_lp/10.

    Marches until successive cycles agree, then measures one more.

    Parameters
    ----------
    slider : SpringSlider
        Parameters that are named DataArrays make a sweep.
    V_lp : float, str, pint.Quantity or DataArray
        Load-point velocity [m/s], > 0.
    rtol : float
        Relative accuracy of amplitude and period, from 1e-12 to 1e-2.

    Returns
    -------
    xarray.Dataset
        In the sweep's dimensions: ``period`` [s], ``frequency`` [Hz], ``amplitude`` (max - min
        of tau/sigma), ``V_max`` and ``V_min`` [m/s], ``inertia`` (max |tau/sigma - mu| over the
        amplitude), ``status`` (int8 with CF flags).  Status 0 is a cycle; 1 is steady sliding:
        amplitude and inertia are 0, V_max = V_min = V_lp, period and frequency are NaN.

    Raises
    ------
    ParameterError
        An input that cannot be used.
    QuasiStaticInstability
        M = 0, and the motion runs into an instability.
    NotConverged
        Cycles did not settle; ``best`` holds the last one.
    SolverError
        Any other failure.  In a sweep such cases are NaN, with their status.

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m", M=3000)
    >>> cycle = rs.limit_cycle(slider, V_lp="3.2 mm/s")
    >>> round(float(cycle.frequency), 3)  # Hz
    50.595
    """
    checked(slider)
    rtol = to_si("rtol", rtol)
    if is_array(rtol) or not 1e-12 <= rtol <= 1e-2:
        raise ParameterError(f"rtol = {rtol!r} must be one number from 1e-12 to 1e-2, such as 1e-8")
    V_lp = to_si("V_lp", V_lp)
    batch = Batch({**slider.values, "V_lp": V_lp, "V_start": 0.1 * V_lp}, taken=TAKEN)
    with bar("limit_cycle") as progress:
        status, numbers = _settle(batch, evolution_law(slider.law).code, rtol, progress)
    variables = _measures(batch, status, numbers)
    variables["status"] = status_variable(batch, status)
    coords = batch.coordinates(TAKEN)
    coords.pop("V_start", None)
    if not is_array(V_lp):
        coords["V_lp"] = ((), V_lp, attrs("V_lp"))
    result = xarray.Dataset(variables, coords)
    result.attrs = provenance("limit_cycle", slider, rtol=rtol, V_lp=json.dumps(plain(V_lp)))
    if batch.shape == () and status[0] > STEADY_SLIDING:
        best = result if status[0] == NO_CONVERGENCE else None
        raise failure("limit_cycle", slider, status[0], numbers["t"][0], best)
    return result


def _settle(batch, law, rtol, progress):
    """Status (n,) and the engine's numbers (name -> (n,)) of marching until cycles agree."""
    a, b, Dc, sigma, K, M, V = map(batch.flat, ("a", "b", "Dc", "sigma", "K", "M", "V_lp"))
    always_steady = (b <= a) | np.isinf(K)
    steady = K_c(V, a=a, b=b, Dc=Dc, sigma=sigma, M=M) < K
    march_rtol = max(MARCH_RTOL * rtol, 1e-13)
    zeros = np.zeros(batch.n, np.int64)
    cases = engine_cases(
        batch,
        initial_state(batch, V),
        t_end=np.full(batch.n, np.inf),
        loading=np.arange(batch.n),
        times=zeros,
        rtol=march_rtol,
        mode=SEEK,
        cycle_tol=rtol,
        # Where steady sliding is stable, being this near to it is the end of the story.
        steady_tol=np.where(steady, 10.0 * march_rtol, 0.0),
        max_steps=np.minimum(MAX_STEPS * (1.0 + eta(V, a=a, Dc=Dc, sigma=sigma, M=M)), MOST_STEPS),
    )
    loads = Loads(np.zeros(1), V[:, None].copy(), np.zeros((batch.n, 1)))
    which = np.flatnonzero(~always_steady)
    results = run_cases("rodas5p", law, cases, loads, np.empty((1, 0)), which, progress)
    results.status[always_steady] = STEADY_SLIDING
    return results.status, dict(zip(NUMBERS, results.numbers.T, strict=True))


def _measures(batch, status, numbers):
    """The result's variables, name -> Variable; `numbers` of a settled cycle or the last one."""
    a, Dc, V0, V = map(batch.flat, ("a", "Dc", "V0", "V_lp"))
    steady = status == STEADY_SLIDING
    known = (status < STEADY_SLIDING) | ((status == NO_CONVERGENCE) & (batch.shape == ()))
    period = np.where(known, numbers["period"] * Dc / V0, np.nan)
    amplitude = np.where(known, numbers["amplitude"], np.nan)

    def where_cycle(value, if_steady):
        return np.where(known, value, np.where(steady, if_steady, np.nan))

    with np.errstate(divide="ignore", invalid="ignore"):
        values = {
            "period": period,
            "frequency": 1.0 / period,
            "amplitude": where_cycle(a * amplitude, 0.0),
            "V_max": where_cycle(speed(numbers["v_max"], V0), V),
            "V_min": where_cycle(speed(numbers["v_min"], V0), V),
            "inertia": where_cycle(numbers["g_max"] / amplitude, 0.0),
        }
    return {name: batch.variable(value, name) for name, value in values.items()}
