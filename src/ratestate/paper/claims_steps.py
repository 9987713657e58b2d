"""Check the paper's claims about velocity steps: friction (Fig. 1) and stability (Figs 2, 3)."""

import functools
import math

import numpy as np
import xarray

from .. import Loading, limit_cycle, logspace, simulate, stability
from ..dynamics.results import parameter
from .claim import TIGHT, after_step, by_scheme, exact, pair
from .fig3 import UNSTABLE
from .parameters import FIG1, FIG2, FIG2_DURATION, FIG2_SPEEDS, FIG2_START, FIG3_M, FIG3_V_LP
from .scheme import FINER, LARGEST, LAST, critical_velocity, step_response, time_step

RTOL = 1e-8, 1e-6  # of the map; the second shows that the first is enough
STIFFNESS = 1e5  # 1/m, the paper's K/sigma in Fig. 1
POINTS = 4001  # of a response in Fig. 1


def on_friction(law):
    """Measure the claims of Fig. 1, a rigid drive's e-fold step: id -> arguments of `claim`."""
    slider = FIG1.replace(law=law)
    a, b, Dc, mu0 = slider.a, slider.b, slider.Dc, slider.mu0
    reach = 30 * Dc  # exp(-30) of the fall is rounding
    mu, slip = _friction(slider, reach), np.linspace(0.0, reach, POINTS)
    remaining = (mu - mu[-1]) / (mu[0] - mu[-1])
    begin = slip < 2 * Dc
    distance = np.interp(1.0, -np.log(remaining[begin]), slip[begin])
    exact = Dc if law == "slip" else Dc * math.log((math.e - 1) / math.expm1(1 / math.e))
    values = {
        "direct_effect": (mu[0] - mu0, a),
        "evolution_effect": (mu[0] - mu[-1], b),
        "evolution_distance": (1e6 * distance, 1e6 * exact),
        "net_change": (mu[-1] - mu0, a - b),
    }
    peak = _friction(slider.replace(K=STIFFNESS * slider.sigma), 10 * Dc).max() - mu0
    return {
        name: {
            "converged": (float(value),),
            "error": abs(float(value) - closed_form),
            "error_from": "against the closed form of a rigid drive",
            "texts": {"peak": peak},
        }
        for name, (value, closed_form) in values.items()
    }


def _friction(slider, reach):
    """Return mu after an e-fold step from V0, at even slips of the load point to `reach` [m]."""
    V = math.e * slider.V0
    times = np.linspace(0.0, reach / V, POINTS)
    step = {"V_start": slider.V0, "times": times, "rtol": TIGHT}
    return simulate(slider, Loading.constant(V), times[-1], **step).mu.values


def on_steps(law):
    """Measure the claims of Fig. 2: id -> arguments of `claim`."""
    slider = FIG2.replace(law=law)
    rates = [float(stability(slider, V).growth_rate) for V in FIG2_SPEEDS]
    at_V_c = abs(float(stability(slider, slider.V_c).growth_rate))
    slope = (rates[2] - rates[1]) / (FIG2_SPEEDS[2] - FIG2_SPEEDS[1])
    V_c = {
        "converged": (1e3 * slider.V_c,),
        "error": 1e3 * max(at_V_c / slope, 1e-15 * slider.V_c),
        "error_from": "growth rate of the linear modes at V_c, divided by its slope",
        **by_scheme(lambda od: 1e3 * critical_velocity(slider, od), slider, LARGEST, FINER),
    }
    measured = {
        "K_c_qs": exact(1e-6 * slider.K_c_qs),
        "V_c": V_c,
        "K_c_of_steps": exact(*(1e-6 * slider.K_c(V) for V in FIG2_SPEEDS[1:])),
        "first_swing": pair(lambda rtol: _largest_speeds(slider, rtol)),
        "growth_rates": exact(*rates),
        **{f"step_to_{1e3 * V:g}": _remaining_oscillation(slider, V) for V in FIG2_SPEEDS},
        "cycle_range": _cycle(slider, FIG2_SPEEDS[-1]),
    }
    return {name: row | {"texts": {"largest": LARGEST}} for name, row in measured.items()}


def _largest_speeds(slider, rtol):
    """Return the largest V/V_lp after each step."""
    V_lp = xarray.DataArray(FIG2_SPEEDS, dims="V_lp")
    run = simulate(slider, Loading.constant(V_lp), 1.0, V_start=FIG2_START, rtol=rtol)
    return run.V_max.values / V_lp.values


def _remaining_oscillation(slider, V_lp):
    """Measure the oscillation that is left after the step to V_lp."""
    times = FIG2_DURATION + np.linspace(-LAST, 0.0, 2001)
    step = FIG2_START, V_lp, FIG2_DURATION, LAST
    return after_step(_amplitude, slider, *step, [LARGEST, FINER], times)


def _amplitude(run):
    return float(run.tau.max() - run.tau.min()) / parameter(run, "sigma")


def _cycle(slider, V_lp):
    def measure(rtol):
        cycle = limit_cycle(slider, V_lp, rtol=rtol)
        return 1e3 * cycle.V_min, 1e3 * cycle.V_max

    def of_scheme(omega_dt):
        run = step_response(slider, FIG2_START, V_lp, FIG2_DURATION, omega_dt)
        return 1e3 * run.V.min(), 1e3 * run.V.max()

    return pair(measure) | by_scheme(of_scheme, slider, LARGEST, FINER)


def on_map(law):
    """Measure the claims of Fig. 3: id -> arguments of `claim`."""
    slider = FIG2.replace(law=law, M=logspace("M", *FIG3_M))
    V_lp = logspace("V_lp", *FIG3_V_LP)
    is_above = V_lp > slider.V_c

    @functools.cache
    def amplitude(rtol):
        """Return the amplitude of the last oscillation, 10 s after the step."""
        loading = Loading.constant(V_lp)
        run = simulate(slider, loading, FIG2_DURATION, V_start=FIG2_START, rtol=rtol)
        return run.amplitude

    scheme, repeated = _cases_by_scheme(law, V_lp)
    last = amplitude(RTOL[0])
    texts = {
        "unstable": UNSTABLE,
        "below": float(last.where(~is_above).max()),
        "least": float(last.where(is_above).min()),
        "repeated": repeated,
    }
    cases = pair(lambda rtol: ((amplitude(rtol) > UNSTABLE) == is_above).sum(), *RTOL)
    return {
        "cases_at_10_s": cases | {"scheme": scheme, "texts": texts},
        "cases_converged": pair(
            lambda rtol: ((limit_cycle(slider, V_lp, rtol=rtol).status == 0) == is_above).sum()
        ),
    }


def _is_wrong(slider, V_lp, omega_dt):
    """Return whether the scheme puts a case of Fig. 3 on the wrong side of V_c."""
    run = step_response(slider, FIG2_START, V_lp, FIG2_DURATION, omega_dt)
    return (_amplitude(run) > UNSTABLE) != (V_lp > slider.V_c)


def _cases_by_scheme(law, V_lp):
    """Count the cases on the right side by the scheme, and those that its large step gets wrong."""
    sliders = [FIG2.replace(law=law, M=float(M)) for M in logspace("M", *FIG3_M)]
    cases = [(slider, V) for slider in sliders for V in V_lp.values.tolist()]
    wrong = [case for case in cases if _is_wrong(*case, LARGEST)]
    still_wrong = sum(_is_wrong(*case, FINER) for case in wrong)
    counts = {LARGEST: len(cases) - len(wrong), FINER: len(cases) - still_wrong}
    ends = sliders[0], sliders[-1]  # dt goes with sqrt(M)
    return {
        (od, *(time_step(slider, od) for slider in ends)): (float(n),) for od, n in counts.items()
    }, len(wrong)
