"""Claims on stability over mass and loading velocity: Fig. 3."""

from ..dynamics.cycles.limit_cycle import limit_cycle
from ..dynamics.simulation.simulate import simulate
from ..model.arrays import logspace
from ..model.loading import Loading
from .claim import pair
from .claims_steps import LAST, last_amplitude
from .fig3 import UNSTABLE
from .parameters import FIG2, FIG2_DURATION, FIG2_START, FIG3_M, FIG3_V_LP
from .scheme_map import FINER, LARGEST, METHOD, step_response, time_step

RTOL = 1e-8, 1e-6  # the second shows that the first is enough


def on_map(law):
    """The claims of Fig. 3."""
    slider = FIG2.replace(law=law, M=logspace("M", *FIG3_M))
    V_lp = logspace("V_lp", *FIG3_V_LP)
    above = V_lp > slider.V_c

    amplitudes = [_after_10_s(slider, V_lp, rtol) for rtol in RTOL]
    counts = [float(((amplitude > UNSTABLE) == above).sum()) for amplitude in amplitudes]
    below = float(amplitudes[0].where(~above).max())
    least = float(amplitudes[0].where(above).min())
    scheme, repeated = _by_scheme(law, V_lp, above)

    def cycles(rtol):
        status = limit_cycle(slider, V_lp, rtol=rtol).status
        return (float(((status == 0) == above).sum()),)

    return {
        "cases_at_10_s": {
            "converged": (counts[0],),
            "error": abs(counts[0] - counts[1]),
            "error_from": f"difference between rtol {RTOL[0]:g} and {RTOL[1]:g}",
            "scheme": scheme,
            "texts": {"unstable": UNSTABLE, "below": below, "least": least, "repeated": repeated},
        },
        "cases_converged": pair(cycles),
    }


def _after_10_s(slider, V_lp, rtol):
    """Amplitude of the last oscillation, 10 s after the step."""
    run = simulate(slider, Loading.constant(V_lp), FIG2_DURATION, V_start=FIG2_START, rtol=rtol)
    return run.amplitude


def _by_scheme(law, V_lp, above):
    """Cases on the right side by the scheme, and how many its large step puts on the wrong one.

    dt goes with sqrt(M): the table states those of the smallest and the largest mass.
    """
    wrong = []
    for M in above.M.values:
        slider = FIG2.replace(law=law, M=float(M))
        run = step_response(slider, FIG2_START, V_lp, FIG2_DURATION, LARGEST, METHOD[law])
        unstable = run.amplitude > UNSTABLE
        wrong += [(slider, float(V)) for V in V_lp[(unstable != above.sel(M=M)).values]]
    still = 0
    for slider, V in wrong:
        run = step_response(slider, FIG2_START, V, FIG2_DURATION, FINER, METHOD[law], LAST)
        still += (last_amplitude(run)[0] > UNSTABLE) != (slider.V_c < V)
    ends = [FIG2.replace(M=float(above.M[i])) for i in (0, -1)]
    counts = {LARGEST: above.size - len(wrong), FINER: above.size - still}
    steps = {
        (od, *(time_step(slider, od) for slider in ends)): (float(n),) for od, n in counts.items()
    }
    return steps, len(wrong)
