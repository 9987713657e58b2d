"""Check the paper's claims about limit cycles (Figs 4, 5, section 5) and inertia (Figs 4, 6)."""

import math

import numpy as np
import scipy
import xarray

from .. import Loading, limit_cycle, logspace, stability
from ..dynamics.cycles.limit_cycle import orbit
from ..dynamics.results import parameter
from .claim import LOOSE, SENTENCES, TIGHT, after_step, by_scheme, exact, floats, pair
from .fig6 import inertia
from .parameters import FIG2, FIG2_SPEEDS, FIG4, FIG4_EXAMPLES, FIG4_K, FIG6, FIG6_SPEEDS
from .scheme import EULER, FINER, LARGEST, last_cycle, step_response, time_step
from .scheme_run import im2017

SLOW = logspace("V_lp", 1e-5, 1e-3, 5)  # where the decrease is log-linear
MIDDLE = logspace("V_lp", 1e-2, 1e-1, 21)  # about the smallest amplitude
FAST = logspace("V_lp", 10**-0.5, 10.0, 4)  # up to ten times the rates of Fig. 4
SWEEP = xarray.concat([SLOW, MIDDLE, FAST], "V_lp")
GROWN = 1.0  # m/s, where Fig. 4 ends
HALF_AS_DENSE = "difference from a sweep half as dense"
CYCLES = 40  # after which the examples of Fig. 4 have settled
SHARE = 0.01  # of the amplitude, beyond which inertia counts as acting
SETTLED = 300.0  # s in which Fig. 6 settles by the scheme
FIRST = 1.0  # s after the step of Fig. 6 that hold its first drop


def on_cycles(law):
    """Measure the claims of Figs 4 and 5: id -> arguments of `claim`."""
    sliders = [FIG4.replace(law=law, K=K) for K in FIG4_K]
    sweeps = {rtol: [limit_cycle(s, SWEEP, rtol=rtol) for s in sliders] for rtol in (TIGHT, LOOSE)}
    best = sweeps[TIGHT]
    of_scheme = [_scheme(s, c) for s, c in zip(sliders, best, strict=True)]

    def by_branch(measure, branches=(0, 1)):
        """Apply a measure of (slider, sweep) to these branches: converged, and by the scheme."""

        def values(sweep):
            return floats([measure(sliders[i], sweep[i]) for i in branches])

        dt = (time_step(sliders[i], LARGEST) for i in branches)
        measured = pair(lambda rtol: values(sweeps[rtol]))
        return measured | {"scheme": {(LARGEST, *dt): values(of_scheme)}}

    def at_minimum(measure, branches=(0, 1), factor=1.0):
        """Apply a measure of (slider, V_lp) at the smallest amplitude, times a factor."""

        def value(slider, sweep, stride=1):
            return measure(slider, _minimum(sweep, stride)[0])

        slips = (value(sliders[i], best[i]) - value(sliders[i], best[i], 2) for i in branches)
        error = {"error": factor * max(map(abs, slips)), "error_from": HALF_AS_DENSE}
        return by_branch(lambda *case: factor * value(*case), branches) | error

    texts = {
        "grown": GROWN,
        "worst": 100 * _worst(best, of_scheme),
        "fastest": " ".join(map(_fastest, sliders)),
        **_effects_of_reversal(sliders, best),
    }
    measures = {
        "slope": lambda slider, sweep: _line(sweep, sweep.V_lp)[0],
        "log_linear": lambda slider, sweep: _line(sweep, sweep.V_lp)[1],
        "log_linear_in_frequency": lambda slider, sweep: _line(sweep, sweep.frequency)[1],
        "all_cycles": lambda slider, sweep: (sweep.status == 0).mean(),
        "growth": lambda slider, sweep: sweep.amplitude.sel(V_lp=GROWN) / _minimum(sweep)[1],
        "frequency_limit": lambda slider, sweep: sweep.frequency.max() / slider.f_n,
        "frequency_rises": lambda slider, sweep: np.min(
            np.diff(np.log(sweep.frequency)) / np.diff(np.log(sweep.V_lp))
        ),
    }
    measured = {name: by_branch(measure) for name, measure in measures.items()} | {
        "eta_at_minimum": at_minimum(lambda slider, V_lp: slider.eta(V_lp)),
        "eta_1": exact(1e2 / math.sqrt(FIG4.eta(1.0))),
        "K_c_qs_fig4": exact(FIG4.K_c_qs / 1e9),
        "f_n": exact(*(slider.f_n for slider in sliders)),
        "finite_at_rest": pair(lambda rtol: [_turned(s, rtol).frequency / s.f_n for s in sliders]),
    }
    rows = {name: row | {"texts": texts} for name, row in measured.items()}
    for i, K in enumerate(FIG4_K):
        minimum = at_minimum(lambda slider, V_lp: V_lp, (i,), 1e2)
        rows[f"minimum_{K / 1e9:.2f}"] = minimum | {"texts": {"above": 100 * _excess(best[i])}}
    return rows


def _turned(slider, rtol):
    """Return the cycle at the end of the inset of Fig. 5 if friction lets slip reverse."""
    return limit_cycle(slider.replace(friction_form="regularized"), float(SWEEP[-1]), rtol=rtol)


def _effects_of_reversal(sliders, sweeps):
    """Return what such friction changes: relative amplitude, and the smallest V/V_lp."""
    cycles = [_turned(slider, TIGHT) for slider in sliders]
    pairs = zip(cycles, sweeps, strict=True)
    changes = [abs(float(cycle.amplitude / sweep.amplitude[-1]) - 1.0) for cycle, sweep in pairs]
    slowest = min(float(cycle.V_min) for cycle in cycles)
    return {"apart": max(changes), "slowest": slowest / SWEEP[-1]}


def _fastest(slider):
    """Describe how the slider moves at the end of the inset of Fig. 5."""
    V_lp = float(SWEEP[-1])
    turn = orbit(slider, V_lp)
    stress, slowest = turn.tau / slider.sigma, turn.isel(time=turn.V.argmin("time"))
    return SENTENCES(
        "text.fastest",
        V_lp=V_lp,
        K=slider.K / 1e9,
        stress=float(stress.min()),
        V=float(slowest.V) / V_lp,
        mu=float(slowest.mu),
        side="outside" if turn.outside_domain else "inside",
        margin=float(turn.reversal_margin),
    )


def _scheme(slider, cycles):
    """Return amplitude and frequency at the end of the scheme's runs, along the sweep."""
    # a few cycles of stick-slip are enough; fast ones relax in 2 M V/((b - a) sigma), 0.2 s a m/s
    settings = {"dt": time_step(slider, LARGEST), "euler": EULER[slider.law]}
    found = np.empty((2, SWEEP.size))
    for i, V in enumerate(SWEEP.values.tolist()):
        t_end = 4 * float(cycles.period[i]) + 0.2 + 2.0 * V
        run = im2017(slider, Loading.constant(V), t_end, V_start=0.1 * V, **settings)
        found[:, i] = last_cycle(run)
    amplitude, frequency = found
    variables = {"amplitude": amplitude, "frequency": frequency, "status": np.zeros(SWEEP.size)}
    return cycles[[*variables]].copy(data=variables)


def _worst(cycles, by_scheme):
    pairs = zip(by_scheme, cycles, strict=True)
    ratios = [(s.amplitude / c.amplitude).sel(V_lp=SLOW.values) for s, c in pairs]
    return max(float(abs(ratio - 1.0).max()) for ratio in ratios)


def _line(sweep, against):
    """Fit a line to the slow amplitudes: slope per decade, and the largest departure."""
    slow = sweep.amplitude.sel(V_lp=SLOW.values).values
    decades = np.log10(against.sel(V_lp=SLOW.values).values)
    fit = np.polyfit(decades, slow, 1)
    return fit[0], np.abs(slow - np.polyval(fit, decades)).max() / (slow[0] - slow[-1])


def _minimum(sweep, stride=1):
    """Return V_lp [m/s] and value of the least amplitude, by a quartic through five speeds."""
    V = np.log(MIDDLE.values[::stride])
    middle = sweep.amplitude.sel(V_lp=MIDDLE.values).values[::stride]
    i = min(max(int(np.argmin(middle)), 2), V.size - 3)
    fit = np.polyfit(V[i - 2 : i + 3] - V[i], middle[i - 2 : i + 3], 4)
    turns = np.roots(np.polyder(fit))
    at = min(turns, key=abs).real
    return math.exp(V[i] + at), np.polyval(fit, at)


def _excess(sweep):
    """Return by how much the amplitude at 3 cm/s exceeds the smallest."""
    middle = sweep.amplitude.sel(V_lp=MIDDLE.values)
    between = scipy.interpolate.make_interp_spline(np.log(MIDDLE.values), middle)
    return float(between(math.log(0.03))) / _minimum(sweep)[1] - 1


def on_regimes(law):
    """Measure the claims of Figs 4b and 4c, and of section 5: id -> arguments of `claim`."""
    slider = FIG4.replace(law=law)
    inertia = {f"inertia_in_{name}": _inertia(slider, V) for name, V in FIG4_EXAMPLES.items()}
    return inertia | _conclusions(FIG2.replace(law=law))


def _inertia(slider, V_lp):
    """Measure in which part of a cycle inertia acts."""
    period = float(limit_cycle(slider, V_lp).period)
    step = 0.1 * V_lp, V_lp, CYCLES * period, period
    texts = {"share": 100 * SHARE, "V_lp": V_lp}
    return after_step(_share, slider, *step, [LARGEST]) | {"texts": texts}


def _share(run):
    """Return the share of a run's time in which inertia acts, linear between its points."""
    stress = run.tau.values / parameter(run, "sigma")
    excess = np.abs(stress - run.mu.values) - SHARE * (stress.max() - stress.min())
    low, high = np.sort([excess[:-1], excess[1:]], axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.where(low >= 0, 1.0, np.where(high <= 0, 0.0, high / (high - low)))
    dt = np.diff(run.time.values)
    return float((part * dt).sum() / dt.sum())


def _conclusions(slider):
    stiff = [slider.replace(K=factor * slider.K_c_qs) for factor in (2.0, 10.0, 100.0)]
    strengthening = slider.replace(b=0.9 * slider.a, K=1e-3 * slider.K_c_qs)
    light = slider.replace(M=0.1 * slider.M)

    def growth(slider, V_lp):
        return float(stability(slider, V_lp).growth_rate)

    def frequency(slider, rtol):
        return float(limit_cycle(slider, 1.1 * slider.V_c, rtol=rtol).frequency)

    return {
        "inertia_destabilises": exact(
            *(growth(case, FIG2_SPEEDS[-1]) for case in (slider.replace(M=0.0), slider))
        ),
        "any_stiffness": exact(*(growth(s, 1.01 * s.V_c) / s.V_c * s.Dc for s in stiff)),
        "weakening_needed": exact(
            max(growth(strengthening, V) for V in np.geomspace(1e-9, 10, 41))
        ),
        "less_mass": pair(
            lambda rtol: (light.V_c / slider.V_c, frequency(light, rtol) / frequency(slider, rtol))
        ),
    }


def on_slow_slip(law):
    """Measure the claims of Fig. 6: id -> arguments of `claim`."""
    slider = FIG6.replace(law=law)
    slow, fast = FIG6_SPEEDS
    fastest = float(limit_cycle(FIG4.replace(law=law), FIG4_EXAMPLES["stick_slip"]).V_max)

    settled = step_response(slider, slow, fast, SETTLED, LARGEST, last=FIRST)
    #: claim -> variable of the limit cycle; over what; the same by the scheme
    of_the_cycle = {
        "slow_cycle": ("amplitude", 1.0, last_cycle(settled)[0]),
        "slow_slip": ("V_max", fastest, settled.V.max()),
        "slow_inertia": ("inertia", 1.0, inertia(settled)),
    }

    def cycle(name, scale, scheme):
        measured = pair(lambda rtol: limit_cycle(slider, fast, rtol=rtol)[name] / scale)
        return measured | by_scheme(lambda omega_dt: scheme / scale, slider, LARGEST)

    return {
        "eta_fig6": exact(slider.eta(fast)),
        "K_over_K_c_fig6": exact(slider.K / slider.K_c(fast)),
        **{name: cycle(*row) for name, row in of_the_cycle.items()},
        "first_drop_inertia": after_step(
            inertia, slider, slow, fast, FIRST, FIRST, [LARGEST, FINER]
        ),
    }
