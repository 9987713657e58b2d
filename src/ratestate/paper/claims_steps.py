"""Claims on steps across the critical velocity: Fig. 2, section 3.1."""

import math

import numpy as np
import xarray

from ..dynamics.cycles.limit_cycle import limit_cycle
from ..dynamics.simulation.simulate import simulate
from ..dynamics.steady_sliding import stability
from ..model.loading import Loading
from .claim import Claim, exact, pair, to_digits
from .fig3 import UNSTABLE
from .parameters import FIG2, FIG2_DURATION, FIG2_SPEEDS, FIG2_START
from .scheme_map import FINER, LARGEST, METHOD, critical_velocity, step_response, time_step

LAST = 0.1  # s at the end of a run in which its oscillation is measured
STEADY, OSCILLATES = (0.0, UNSTABLE), (UNSTABLE, math.inf)


def on_steps(law):
    """The claims of Fig. 2."""
    slider = FIG2.replace(law=law)
    below, above = (1e-6 * slider.K_c(V) for V in FIG2_SPEEDS[1:])
    steps = {od: (od, time_step(slider, od)) for od in (LARGEST, FINER)}
    scheme_V_c = {
        step: (1e3 * critical_velocity(slider, od, METHOD[law]),) for od, step in steps.items()
    }
    rates = [float(stability(slider, V).growth_rate) for V in FIG2_SPEEDS]
    at_V_c = abs(float(stability(slider, slider.V_c).growth_rate))
    slope = (rates[2] - rates[1]) / (FIG2_SPEEDS[2] - FIG2_SPEEDS[1])
    rows = [
        Claim(
            id="K_c_qs",
            where="sec. 3.1",
            claim="Quasi-static critical stiffness of the Fig. 2 parameters.",
            paper="600 MPa/m",
            unit="MPa/m",
            covers=(to_digits(600, 1),),
            **exact(1e-6 * slider.K_c_qs),
        ),
        Claim(
            id="V_c",
            where="sec. 3.1, eq. 10",
            claim="Sliding faster than V_c is unstable.",
            paper="3.16 mm/s",
            unit="mm/s",
            converged=(1e3 * slider.V_c,),
            error=1e3 * max(at_V_c / slope, 1e-15 * slider.V_c),
            error_from="growth rate of the linear modes at V_c, over its slope",
            scheme=scheme_V_c,
            covers=(to_digits(3.16, 0.01),),
            note="The scheme is anti-damped at order 1 in dt: its steady sliding turns unstable "
            "too early (figure scheme).",
        ),
        Claim(
            id="K_c_of_steps",
            where="sec. 3.1, Fig. 2b",
            claim="K = 900 MPa/m lies between K_c at 3.1 and at 3.2 mm/s.",
            paper="K_c(3.1) < 900 < K_c(3.2)",
            unit="MPa/m",
            covers=((-math.inf, 900.0), (900.0, math.inf)),
            **exact(below, above),
        ),
        Claim(
            id="first_swing",
            where="sec. 3.1, Fig. 2a",
            claim="All three steps, to 0.3, 3.1 and 3.2 mm/s, first set off an oscillation: "
            "largest V/V_lp.",
            paper="an oscillation",
            unit="",
            covers=((1.0, math.inf),) * 3,
            **pair(lambda rtol: _swing(slider, rtol)),
        ),
        Claim(
            id="growth_rates",
            where="sec. 3.1, Fig. 2a",
            claim="It then decays at 0.3 and, more slowly, at 3.1 mm/s, and lasts at 3.2 mm/s: "
            "growth rates of small oscillations.",
            paper="decay, slow decay, no decay",
            unit="1/s",
            covers=((-math.inf, 0.0), (-math.inf, 0.0), (0.0, math.inf)),
            **exact(*rates),
        ),
    ]
    return [*rows, *(_fate(slider, V, steps) for V in FIG2_SPEEDS), _cycle(slider, steps)]


def _fate(slider, V_lp, steps):
    """Whether the oscillation after the step to V_lp has died out."""
    fate = "a lasting oscillation" if V_lp > slider.V_c else "steady sliding"
    found = {
        (od, dt): last_amplitude(
            step_response(slider, FIG2_START, V_lp, FIG2_DURATION, od, METHOD[slider.law], LAST)
        )
        for od, dt in steps.values()
    }
    note = ""
    if V_lp < slider.V_c < 1.1 * V_lp:
        note = f"By the scheme with omega dt = {LARGEST:g} this speed lies above V_c"
        slip = (
            ": the paper's runs find it stable, so by this form of the scheme took smaller steps."
        )
        note += slip if slider.law == "slip" else "."
    return Claim(
        id=f"step_to_{1e3 * V_lp:g}",
        where="sec. 3.1, Fig. 2a",
        claim=f"A step from 0.1 to {1e3 * V_lp:g} mm/s ends in {fate}: oscillation of tau/sigma "
        "10 s later.",
        paper=fate,
        unit="",
        scheme=found,
        covers=(OSCILLATES if V_lp > slider.V_c else STEADY,),
        note=note,
        **pair(lambda rtol: _end_of_step(slider, V_lp, rtol)),
    )


def _swing(slider, rtol):
    """Largest V/V_lp after each step."""
    V_lp = xarray.DataArray(FIG2_SPEEDS, dims="V_lp")
    run = simulate(slider, Loading.constant(V_lp), 1.0, V_start=FIG2_START, rtol=rtol)
    return tuple((run.V_max.values / V_lp.values).tolist())


def _end_of_step(slider, V_lp, rtol):
    times = FIG2_DURATION + np.linspace(-LAST, 0.0, 2001)
    return last_amplitude(
        simulate(
            slider,
            Loading.constant(V_lp),
            FIG2_DURATION,
            V_start=FIG2_START,
            times=times,
            rtol=rtol,
        )
    )


def last_amplitude(run):
    """Max - min of tau/sigma over what was saved."""
    return (float(run.tau.max() - run.tau.min()) / FIG2.sigma,)


def _cycle(slider, steps):
    V_lp = FIG2_SPEEDS[-1]

    def measure(rtol):
        cycle = limit_cycle(slider, V_lp, rtol=rtol)
        return 1e3 * float(cycle.V_min), 1e3 * float(cycle.V_max)

    runs = {
        (od, dt): step_response(
            slider, FIG2_START, V_lp, FIG2_DURATION, od, METHOD[slider.law], LAST
        )
        for od, dt in steps.values()
    }
    slip = slider.law == "slip"
    return Claim(
        id="cycle_range",
        where="sec. 3.1, Fig. 2a",
        claim="Smallest and largest slip velocity of the limit cycle at 3.2 mm/s.",
        paper="about 2.6 to 4 mm/s" if slip else "",
        unit="mm/s",
        scheme={step: (1e3 * float(r.V.min()), 1e3 * float(r.V.max())) for step, r in runs.items()},
        covers=(to_digits(2.6, 0.1), to_digits(4, 1)) if slip else (),
        note="The scheme's error widens the cycle, as an excess over V_c would; it shrinks with dt "
        "to the converged range (figure scheme)."
        + (" Steps near omega dt = 0.01 give the paper's range and its stable 3.1 mm/s." * slip),
        **pair(measure),
    )
