"""Claims on stability over mass and loading velocity: Fig. 3."""

import functools

from ..dynamics.cycles.limit_cycle import limit_cycle
from ..dynamics.simulation.simulate import simulate
from ..model.arrays import logspace
from ..model.loading import Loading
from .claim import pair
from .claims_steps import LAST, last_amplitude
from .fig3 import UNSTABLE
from .parameters import FIG2, FIG2_DURATION, FIG2_START, FIG3_M, FIG3_V_LP
from .scheme_map import FINER, LARGEST, step_response, time_step

RTOL = 1e-8, 1e-6  # the second shows that the first is enough


def on_map(law):
    """The claims of Fig. 3."""
    slider = FIG2.replace(law=law, M=logspace("M", *FIG3_M))
    V_lp = logspace("V_lp", *FIG3_V_LP)
    above = V_lp > slider.V_c

    @functools.cache
    def amplitude(rtol):
        """Amplitude of the last oscillation, 10 s after the step."""
        loading = Loading.constant(V_lp)
        run = simulate(slider, loading, FIG2_DURATION, V_start=FIG2_START, rtol=rtol)
        return run.amplitude

    scheme, repeated = _by_scheme(law, V_lp)
    last = amplitude(RTOL[0])
    texts = {
        "unstable": UNSTABLE,
        "below": float(last.where(~above).max()),
        "least": float(last.where(above).min()),
        "repeated": repeated,
    }
    cases = pair(lambda rtol: ((amplitude(rtol) > UNSTABLE) == above).sum(), *RTOL)
    return {
        "cases_at_10_s": cases | {"scheme": scheme, "texts": texts},
        "cases_converged": pair(
            lambda rtol: ((limit_cycle(slider, V_lp, rtol=rtol).status == 0) == above).sum()
        ),
    }


def _by_scheme(law, V_lp):
    """Cases on the right side by the scheme, and how many its large step puts on the wrong one.

    dt goes with sqrt(M): the table states those of the smallest and the largest mass.
    """
    sliders = [FIG2.replace(law=law, M=float(M)) for M in logspace("M", *FIG3_M)]
    wrong = []
    for slider in sliders:
        run = step_response(slider, FIG2_START, V_lp, FIG2_DURATION, LARGEST)
        misplaced = (run.amplitude > UNSTABLE) != (V_lp > slider.V_c)
        wrong += [(slider, float(V)) for V in V_lp[misplaced.values]]
    still = 0
    for slider, V in wrong:
        run = step_response(slider, FIG2_START, V, FIG2_DURATION, FINER, last=LAST)
        still += (last_amplitude(run) > UNSTABLE) != (slider.V_c < V)
    cases = len(sliders) * V_lp.size
    counts = {LARGEST: cases - len(wrong), FINER: cases - still}
    ends = sliders[0], sliders[-1]
    return {
        (od, *(time_step(slider, od) for slider in ends)): (float(n),) for od, n in counts.items()
    }, len(wrong)
