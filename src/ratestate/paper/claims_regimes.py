"""Claims on where inertia acts (Figs 4b, 4c, 6), and on what makes slip unstable (section 5)."""

import numpy as np

from .. import limit_cycle, stability
from ..dynamics.results import parameter
from .claim import after_step, by_scheme, exact, pair
from .fig6 import inertia
from .parameters import FIG2, FIG2_SPEEDS, FIG4, FIG4_EXAMPLES, FIG6, FIG6_SPEEDS
from .scheme_map import FINER, LARGEST, last_cycle, step_response

CYCLES = 40  # after which the examples of Fig. 4 have settled
SHARE = 0.01  # of the amplitude, beyond which inertia counts as acting
SETTLED = 300.0  # s in which Fig. 6 settles by the scheme
FIRST = 1.0  # s after the step of Fig. 6 that hold its first drop


def on_regimes(law):
    """The claims of Figs 4b and 4c, and of section 5: id -> what `claim` takes as measured."""
    slider = FIG4.replace(law=law)
    inertia = {f"inertia_in_{name}": _inertia(slider, V) for name, V in FIG4_EXAMPLES.items()}
    return inertia | _conclusions(FIG2.replace(law=law))


def _inertia(slider, V_lp):
    """In which part of a cycle inertia acts."""
    period = float(limit_cycle(slider, V_lp).period)
    step = 0.1 * V_lp, V_lp, CYCLES * period, period
    texts = {"share": 100 * SHARE, "V_lp": V_lp}
    return after_step(_share, slider, *step, [LARGEST]) | {"texts": texts}


def _share(run):
    """Share of a run's time in which inertia acts; straight lines between its points."""
    stress = run.tau.values / parameter(run, "sigma")
    excess = np.abs(stress - run.mu.values) - SHARE * (stress.max() - stress.min())
    low, high = np.sort([excess[:-1], excess[1:]], axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.where(low >= 0, 1.0, np.where(high <= 0, 0.0, high / (high - low)))
    dt = np.diff(run.time.values)
    return float((part * dt).sum() / dt.sum())


def _conclusions(slider):
    """The claims of section 5."""

    stiff = [slider.replace(K=factor * slider.K_c_qs) for factor in (2.0, 10.0, 100.0)]
    strengthening = slider.replace(b=0.9 * slider.a, K=1e-3 * slider.K_c_qs)
    light = slider.replace(M=0.1 * slider.M)

    def growth(slider, V_lp):
        return float(stability(slider, V_lp).growth_rate)

    def frequency(slider, rtol):
        return float(limit_cycle(slider, 1.1 * slider.V_c, rtol=rtol).frequency)

    return {
        "inertia_destabilises": exact(
            *(growth(one, FIG2_SPEEDS[-1]) for one in (slider.replace(M=0.0), slider))
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
    """The claims of Fig. 6: id -> what `claim` takes as measured."""
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

    def cycle(name, over, scheme):
        measured = pair(lambda rtol: limit_cycle(slider, fast, rtol=rtol)[name] / over)
        return measured | by_scheme(lambda omega_dt: scheme / over, slider, LARGEST)

    return {
        "eta_fig6": exact(slider.eta(fast)),
        "K_over_K_c_fig6": exact(slider.K / slider.K_c(fast)),
        **{name: cycle(*row) for name, row in of_the_cycle.items()},
        "first_drop_inertia": after_step(
            inertia, slider, slow, fast, FIRST, FIRST, [LARGEST, FINER]
        ),
    }
