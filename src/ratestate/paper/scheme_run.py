"""The integration by the paper's scheme, its eqs 8 and 9, at a fixed time step; order 1.

Over a step mass and spring oscillate exactly under the friction of the step's end; velocity,
friction and state there are solved together (Im et al., 2017, doi:10.1002/2017JB014476).  Lengths
are in Dc here, times in seconds:

    v = ln(V/Dc),   psi = ln theta,   u = (tau - tau_1)/(K Dc),   friction A v + B psi,

with A = a sigma/(K Dc), B = b sigma/(K Dc) and tau_1 the friction at V = Dc/s, theta = 1 s.
"""

import math
from typing import NamedTuple

import numpy as np
import xarray

from ..dynamics.recipe import record_scenario
from ..dynamics.refusals import refusal
from ..engine.programs import Program
from ..errors import ParameterError, SolverError
from ..friction.functions import exp, expm1, log
from ..friction.law_formula import LOG
from ..machine import check_fits
from ..model.loading import as_loading
from ..model.names import keywords_checked
from ..model.quantities import attrs
from ..model.slider import check_slider
from ..model.units import is_array, to_si
from .figures import LAWS

SLIP, AGING, EULER = range(3)
MAX_ITERATIONS = 200
# Bytes of memory that a step takes: eleven numbers.
BYTES = 88


class SchemeSteps(NamedTuple):
    """The data of `_march`."""

    state: int  # SLIP, AGING, or EULER: aging by backward Euler
    numbers: np.ndarray  # (7,) `numbers_of` a step, load-point speed at the start, its rate
    y: np.ndarray  # (3,) u, v, psi at the start
    out: np.ndarray  # (n, 3) and after each step


@keywords_checked
def im2017(slider, loading, t_end, dt, *, V_start=None, euler=False):
    """Run the scheme of Im, Marone & Elsworth (2019), eqs 8 and 9, with fixed steps.

    Parameters
    ----------
    slider : SpringSlider
        One slider with mass and a spring, under the slip or the aging law with
        friction_form="log", without damping.
    loading : Loading, or float, str or pint.Quantity
        History of the load point.  The normal stress is constant.
    t_end : float, str or pint.Quantity
        End of the run [s], > 0.
    dt : float, str or pint.Quantity
        Time step [s], at most pi sqrt(M/K).  Steps are a little shorter if the time between two
        changes of the loading is not a multiple of it.
    V_start : float, str or pint.Quantity, optional
        The run starts in steady sliding at this speed [m/s], > 0; by default at the first speed of
        the loading.
    euler : bool
        Advance the state of the aging law by backward Euler, as in the script that the scheme's
        author published.  By default the state is advanced exactly for constant V.

    Returns
    -------
    xarray.Dataset
        Along ``time``, at each step: ``V``, ``V_load`` [m/s], ``theta`` [s], ``delta``,
        ``delta_lp`` [m], ``tau`` [Pa] and ``mu``, as from `simulate`.

    Raises
    ------
    ParameterError
        If an input cannot be used.
    SolverError
        If velocity and friction could not be solved together at the end of a step.

    Notes
    -----
    The error is proportional to dt, and feeds energy into oscillations.

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m", M=3000)
    >>> loading = rs.Loading.constant("3.2 mm/s")
    >>> run = rs.paper.im2017(slider, loading, t_end=1, dt="0.1 ms", V_start="0.1 mm/s")
    >>> run.sizes["time"]
    10001
    """
    check_slider(slider)
    loading = as_loading(loading)
    t_end, dt = to_si("t_end", t_end), to_si("dt", dt)
    V_start = loading.V_first if V_start is None else to_si("V_start", V_start)
    if any(map(is_array, (*slider.values.values(), loading.V, t_end, dt, V_start))):
        raise ParameterError("im2017 is for one slider under one loading", "Call it for each case.")
    if V_start == 0.0:
        raise refusal("simulate.at_rest")
    loading.covers(t_end)
    _check(slider, loading, dt, euler)
    check_fits(BYTES * t_end / dt, f"{t_end / dt:.3g} steps", "Give a larger dt.")
    t, states = _run(state_of(slider, euler), slider, loading, t_end, dt, V_start)
    result = xarray.Dataset(_variables(slider, loading, t, states))
    settings = {"t_end": t_end, "dt": dt, "V_start": V_start, "euler": euler}
    record_scenario(result, "paper.im2017", slider, loading=loading, **settings)
    return result


def _check(slider, loading, dt, euler):
    """Check that the scheme can run this slider and loading."""
    needs = {
        "law='aging' for euler=True": slider.law == "aging" or not euler,
        "law='slip' or 'aging'": slider.law in LAWS,
        "friction_form='log'": slider.friction_form == LOG,
        "damping=0": not slider.values.get("damping"),
        "M > 0": slider.M > 0.0,
        "K < inf": math.isfinite(slider.K),
        "a constant sigma": loading.normal_stress is None,
    }
    for need, is_given in needs.items():
        if not is_given:
            raise ParameterError(
                f"the paper's scheme needs {need}", "Use ratestate.simulate for others."
            )
    if (angle := dt * math.sqrt(slider.K / slider.M)) > math.pi:
        raise ParameterError(
            f"is {angle:.3g}/omega with omega = sqrt(K/M), more than half a natural period",
            "Give dt = 0.1/omega or less.",
            symbol="dt",
            value=f"{dt:g}",
            unit="s",
        )


def state_of(slider, euler):
    """Return how the state is advanced: SLIP, AGING or EULER."""
    return SLIP if slider.law == "slip" else EULER if euler else AGING


def numbers_of(slider, h):
    """Return A, B, the step h, 1 - cos(omega h) and sin(omega h)/omega, for `step`."""
    omega, unit = math.sqrt(slider.K / slider.M), slider.sigma / (slider.K * slider.Dc)
    one_c = 2.0 * math.sin(0.5 * omega * h) ** 2
    return slider.a * unit, slider.b * unit, h, one_c, math.sin(omega * h) / omega


def _run(state, slider, loading, t_end, dt, V_start):
    """Return times (n,) and u, v, psi (n, 3) from t = 0 on."""
    A, B, *_ = numbers_of(slider, dt)
    v = math.log(V_start / slider.Dc)
    t, y = [np.zeros(1)], [np.array([[(A - B) * v, v, -v]])]
    ends = np.minimum(np.append(loading.t[1:], math.inf), t_end)
    for start, end, V, rate in zip(loading.t, ends, loading.V, loading.rate, strict=True):
        if start >= end:
            continue
        n = max(1, math.ceil((end - start) / dt - 1e-9))
        numbers = *numbers_of(slider, (end - start) / n), V / slider.Dc, rate / slider.Dc
        steps = SchemeSteps(state, np.array(numbers), y[-1][-1].copy(), np.full((n, 3), np.nan))
        t.append(np.linspace(start, end, n + 1)[1:])
        y.append(steps.out)
        if not Program(_march, steps)(n):
            at = t[-1][np.argmax(np.isnan(steps.out[:, 0]))]
            raise SolverError(
                f"im2017 stopped at t = {at:.9g} s: friction and velocity could not be solved "
                f"together at the end of a step. Reduce dt.\n{slider!r}"
            )
    return np.concatenate(t), np.concatenate(y)


def _march(run, n):
    """Take n steps; return whether there is a solution at the end of each."""
    numbers = (run.numbers[0], run.numbers[1], run.numbers[2], run.numbers[3], run.numbers[4])
    h, V, rate = run.numbers[2], run.numbers[5], run.numbers[6]
    u, v, psi = run.y[0], run.y[1], run.y[2]
    for i in range(n):
        advance = h * (V + rate * h * (i + 0.5))
        u, v, psi, solved = step(run.state, u, v, psi, advance, numbers)
        if not solved:
            return False
        run.out[i, 0] = u
        run.out[i, 1] = v
        run.out[i, 2] = psi
    return True


def step(state, u, v, psi, advance, numbers):
    """Return u, v, psi at the end of a step, and whether they could be solved for.

    The unknown is v.  Newton's method is kept inside a bracket: the mismatch of eq. 9 runs from
    -inf to inf with v, so a root exists; moves are limited to 2 so that none can overflow.

    advance : of the load point; numbers : `numbers_of` the step
    """
    A, B, h, one_c, sine = numbers
    w = exp(v)
    low, high = -math.inf, math.inf
    new = v
    for _ in range(MAX_ITERATIONS):
        w_new = exp(new)
        psi_new, slope = advance_state(state, psi, new, w_new, h)
        # eqs 8 and 9
        rise = one_c * (A * new + B * psi_new - u) + (1.0 - one_c) * advance - sine * w
        mismatch = w_new + w - 2.0 / h * (advance - rise)
        if mismatch < 0.0:
            low = new
        else:
            high = new
        gradient = w_new + 2.0 / h * one_c * (A + B * slope)
        move = 2.0 if mismatch < 0.0 else -2.0
        if gradient > 0.0:
            move = min(max(-mismatch / gradient, -2.0), 2.0)
        # Rounding in u can hide the root below 1e-13 of v: a move that small is the answer even
        # where the bracket, one of its ends perhaps still infinite, would ask for another.
        tiny = 1e-13 * max(1.0, abs(new))
        if abs(move) > tiny and not low < new + move < high:
            move = 0.5 * (low + high) - new
        if abs(move) <= tiny:
            return u + rise, new, psi_new, True
        new += move
    return u, new, psi, False


def advance_state(state, psi, v, w, h):
    """Return psi after h at the constant velocity w = e**v, and its derivative by v."""
    z = w * h
    decay = exp(-z)
    if state == SLIP:
        y = psi + v
        return y * decay - v, decay * (1.0 - y * z) - 1.0
    theta = exp(psi)
    if state == EULER:
        return log((theta + h) / (1.0 + z)), -z / (1.0 + z)
    grown = -expm1(-z) / w
    new = theta * decay + grown
    return log(new), (z * decay * (1.0 / w - theta) - grown) / new


def _variables(slider, loading, t, states):
    """Return the variables of the result, name -> (dimension, values, attributes)."""
    u, v, psi = states.T
    shift = math.log(slider.Dc / slider.V0)
    mu_1 = slider.mu0 + (slider.a - slider.b) * shift
    tau = slider.sigma * mu_1 + slider.K * slider.Dc * u
    delta_lp = loading.delta_lp(t)
    values = {
        "time": t,
        "V": slider.Dc * np.exp(v),
        "theta": np.exp(psi),
        "delta": delta_lp - tau / slider.K,
        "delta_lp": delta_lp,
        "V_load": loading.V_load(t),
        "tau": tau,
        "mu": mu_1 + slider.a * v + slider.b * psi,
    }
    return {name: ("time", value, attrs(name)) for name, value in values.items()}
