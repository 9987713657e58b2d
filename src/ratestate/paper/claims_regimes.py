"""Claims on where inertia acts (Figs 4b, 4c), and on what makes slip unstable (section 5)."""

import math

import numpy as np

from ..dynamics.cycles.limit_cycle import limit_cycle
from ..dynamics.simulation.simulate import simulate
from ..dynamics.steady_sliding import stability
from ..model.loading import Loading
from .claim import Claim, exact, pair
from .parameters import FIG2, FIG2_SPEEDS, FIG4, FIG4_EXAMPLES
from .scheme_map import LARGEST, METHOD, step_response, time_step

CYCLES = 40  # after which the examples of Fig. 4 have settled
SHARE = 0.01  # of the amplitude, beyond which inertia counts as acting


def on_regimes(law):
    """The claims of Figs 4b and 4c, and of section 5."""
    return [*_inertia(law), *_conclusions(law)]


def _inertia(law):
    rows = {
        "stick_slip": ("only in the short slip of stick-slip", "a short part", (0.0, 0.1)),
        "harmonic": ("throughout quasi-harmonic cycles", "the whole cycle", (0.9, 1.0)),
    }
    slider = FIG4.replace(law=law)
    claims = []
    for name, (text, paper, covers) in rows.items():
        V_lp = FIG4_EXAMPLES[name]
        period = float(limit_cycle(slider, V_lp).period)

        def share(rtol, V_lp=V_lp, period=period):
            t_end = CYCLES * period
            run = simulate(slider, Loading.constant(V_lp), t_end, V_start=0.1 * V_lp, rtol=rtol)
            return (_share(run.sel(time=slice(t_end - period, None)), slider),)

        run = step_response(slider, 0.1 * V_lp, V_lp, CYCLES * period, LARGEST, METHOD[law], period)
        claims.append(
            Claim(
                id=f"inertia_in_{name}",
                where="sec. 3.2, Figs 4b, 4c",
                claim=f"Inertia acts {text}: share of a cycle's time in which |tau/sigma - mu| "
                f"exceeds {100 * SHARE:g} % of the amplitude, at V_lp = {V_lp:g} m/s.",
                paper=paper,
                unit="",
                scheme={(LARGEST, time_step(slider, LARGEST)): (_share(run, slider),)},
                covers=(covers,),
                **pair(share),
            )
        )
    return claims


def _share(run, slider):
    """Share of a run's time in which inertia acts; straight lines between its points."""
    stress = run.tau.values / slider.sigma
    excess = np.abs(stress - run.mu.values) - SHARE * (stress.max() - stress.min())
    low, high = np.sort([excess[:-1], excess[1:]], axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.where(low >= 0, 1.0, np.where(high <= 0, 0.0, high / (high - low)))
    dt = np.diff(run.time.values)
    return float((part * dt).sum() / dt.sum())


def _conclusions(law):
    slider = FIG2.replace(law=law)
    rates = [
        float(stability(s, FIG2_SPEEDS[-1]).growth_rate) for s in (slider.replace(M=0.0), slider)
    ]
    stiff = [slider.replace(K=factor * slider.K_c_qs) for factor in (2.0, 10.0, 100.0)]
    growth = [float(stability(s, 1.01 * s.V_c).growth_rate) / s.V_c * s.Dc for s in stiff]
    strengthening = slider.replace(b=0.9 * slider.a, K=1e-3 * slider.K_c_qs)
    fading = max(float(stability(strengthening, V).growth_rate) for V in np.geomspace(1e-9, 10, 41))
    light = slider.replace(M=0.1 * slider.M)

    def frequencies(rtol):
        return [float(limit_cycle(s, 1.1 * s.V_c, rtol=rtol).frequency) for s in (light, slider)]

    mass = pair(lambda rtol: (light.V_c / slider.V_c, np.divide(*frequencies(rtol)).item()))
    return [
        Claim(
            id="inertia_destabilises",
            where="sec. 5",
            claim="Inertia makes fast sliding unstable: growth rate of small perturbations at "
            "3.2 mm/s, without mass and with it.",
            paper="stable; unstable",
            unit="1/s",
            covers=((-math.inf, 0.0), (0.0, math.inf)),
            **exact(*rates),
        ),
        Claim(
            id="any_stiffness",
            where="sec. 2.3, 4.2",
            claim="Where a < b any spring is unstable at some velocity: growth rate, in V_c/Dc, at "
            "1.01 V_c for K = 2, 10 and 100 K_c_qs.",
            paper="unstable",
            unit="",
            covers=((0.0, math.inf),) * 3,
            **exact(*growth),
        ),
        Claim(
            id="weakening_needed",
            where="sec. 2.3",
            claim="Without velocity weakening sliding is stable: largest growth rate for b = 0.9 a "
            "and K = 0.6 MPa/m, V_lp from 1e-9 to 10 m/s.",
            paper="stable",
            unit="1/s",
            covers=((-math.inf, 0.0),),
            **exact(fading),
        ),
        Claim(
            id="less_mass",
            where="sec. 4.2",
            claim="Less mass raises V_c and the frequency once unstable: ratios of V_c, and of the "
            "frequencies at 1.1 V_c, for a tenth of the mass.",
            paper="both increase",
            unit="",
            covers=((1.0, math.inf),) * 2,
            note="Both by sqrt(10): the three numbers that decide everything are then the same.",
            **mass,
        ),
    ]
