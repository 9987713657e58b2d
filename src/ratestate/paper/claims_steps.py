"""Claims on steps across the critical velocity: Figs 2 and 3, section 3.1."""

import math

import numpy as np

from ..arrays import logspace
from ..cycles import limit_cycle
from ..loading import Loading
from ..simulate import simulate
from ..stability import stability
from .claim import Claim, exact, pair, to_digits
from .fig3 import UNSTABLE
from .parameters import FIG2, FIG2_DURATION, FIG2_SPEEDS, FIG2_START, FIG3_M, FIG3_V_LP
from .scheme_map import FINER, LARGEST, METHOD, critical_velocity, step_response, time_step

LAST = 0.1  # s at the end of a run in which its oscillation is measured
STEADY, OSCILLATES = (0.0, UNSTABLE), (UNSTABLE, math.inf)


def on_steps(law):
    """The claims of Figs 2 and 3."""
    return [*_fig2(law), *_fig3(law)]


def _fig2(law):
    slider = FIG2.replace(law=law)
    below, above = (1e-6 * slider.K_c(V) for V in FIG2_SPEEDS[1:])
    steps = {od: (od, time_step(slider, od)) for od in (LARGEST, FINER)}
    scheme_V_c = {
        step: (1e3 * critical_velocity(slider, od, METHOD[law]),) for od, step in steps.items()
    }
    growth = float(stability(slider, slider.V_c).growth_rate)
    slope = float(stability(slider, 1.001 * slider.V_c).growth_rate) / (0.001 * slider.V_c)
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
            error=max(1e3 * abs(growth / slope), 1e-15 * 1e3 * slider.V_c),
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
    ]
    return [*rows, *(_fate(slider, V, steps) for V in FIG2_SPEEDS), _cycle(slider, steps)]


def _fate(slider, V_lp, steps):
    """Whether the oscillation after the step to V_lp has died out."""
    fate = "a lasting oscillation" if V_lp > slider.V_c else "steady sliding"
    found = {
        (od, dt): _last_amplitude(
            step_response(slider, FIG2_START, V_lp, FIG2_DURATION, od, METHOD[slider.law], LAST)
        )
        for od, dt in steps.values()
    }
    notes = {
        3.1e-3: f"By the scheme with omega dt = {LARGEST:g} this speed lies above V_c: the paper's "
        "runs, which find it stable, took smaller steps.",
    }
    return Claim(
        id=f"step_to_{1e3 * V_lp:g}",
        where="sec. 3.1, Fig. 2a",
        claim=f"A step from 0.1 to {1e3 * V_lp:g} mm/s ends in {fate}: oscillation of tau/sigma "
        "10 s later.",
        paper=f"{fate} ({'above' if V_lp > slider.V_c else 'below'} {UNSTABLE:g})",
        unit="",
        scheme=found,
        covers=(OSCILLATES if V_lp > slider.V_c else STEADY,),
        note=notes.get(V_lp, ""),
        **pair(lambda rtol: _end_of_step(slider, V_lp, rtol)),
    )


def _end_of_step(slider, V_lp, rtol):
    times = FIG2_DURATION + np.linspace(-LAST, 0.0, 2001)
    return _last_amplitude(
        simulate(
            slider, Loading.constant(V_lp), FIG2_DURATION, V_start=FIG2_START, times=times, rtol=rtol
        )
    )


def _last_amplitude(run):
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


def _fig3(law):
    slider = FIG2.replace(law=law, M=logspace("M", *FIG3_M))
    V_lp = logspace("V_lp", *FIG3_V_LP)
    above = V_lp > slider.V_c

    def after_10s(rtol):
        run = simulate(slider, Loading.constant(V_lp), FIG2_DURATION, V_start=FIG2_START, rtol=rtol)
        amplitude = run.amplitude.drop_vars("time", errors="ignore").squeeze()
        return (float(((amplitude > UNSTABLE) == above).sum()),), amplitude

    amplitude = after_10s(1e-8)[1]
    decayed, lasting = float(amplitude.where(~above).max()), float(amplitude.where(above).min())
    scheme, repeated = _fig3_by_scheme(law, V_lp, above)
    common = {"where": "sec. 3.1, Fig. 3", "paper": "all 156", "unit": "", "covers": ((156, 156),)}
    return [
        Claim(
            id="cases_at_10_s",
            claim="Cases of M and V_lp, of 156, on the side of V_c(M) where eq. 10 puts them, 10 s "
            f"after a step from 0.1 mm/s; unstable: tau/sigma oscillates by more than {UNSTABLE:g}.",
            scheme=scheme,
            note="No case is undecided: below V_c the largest oscillation left at 10 s is "
            f"{decayed:.1e}, above it the smallest is {lasting:.1e}. Scheme, finer step: only the "
            f"{repeated} cases that the large one puts on the wrong side were repeated.",
            **common,
            **pair(lambda rtol: after_10s(rtol)[0]),
        ),
        Claim(
            id="cases_converged",
            claim="The same of the converged motion: a limit cycle above V_c(M), none below.",
            note="Reached from steady sliding at V_lp/10.",
            **common,
            **pair(
                lambda rtol: (
                    float(((limit_cycle(slider, V_lp, rtol=rtol).status == 0) == above).sum()),
                )
            ),
        ),
    ]


def _fig3_by_scheme(law, V_lp, above):
    """Cases on the right side by the scheme, and how many its large step puts on the wrong one.

    dt goes with sqrt(M): the table states those of the smallest and the largest mass.
    """
    wrong = []
    for M in above.M.values:
        slider = FIG2.replace(law=law, M=float(M))
        run = step_response(slider, FIG2_START, V_lp, FIG2_DURATION, LARGEST, METHOD[law])
        unstable = run.amplitude.squeeze() > UNSTABLE
        wrong += [(slider, float(V)) for V in V_lp[(unstable != above.sel(M=M)).values]]
    still = 0
    for slider, V in wrong:
        run = step_response(slider, FIG2_START, V, FIG2_DURATION, FINER, METHOD[law], LAST)
        still += (_last_amplitude(run)[0] > UNSTABLE) != (slider.V_c < V)
    ends = [FIG2.replace(M=float(above.M[i])) for i in (0, -1)]
    counts = {LARGEST: above.size - len(wrong), FINER: above.size - still}
    steps = {
        (od, *(time_step(slider, od) for slider in ends)): (float(n),) for od, n in counts.items()
    }
    return steps, len(wrong)
