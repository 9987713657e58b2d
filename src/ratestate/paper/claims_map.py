"""Claims on stability over mass and loading velocity: Fig. 3."""

from typing import Any

from ..dynamics.cycles.limit_cycle import limit_cycle
from ..dynamics.simulation.simulate import simulate
from ..model.arrays import logspace
from ..model.loading import Loading
from .claim import Claim, pair
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

    common: dict[str, Any] = {
        "where": "sec. 3.1, Fig. 3",
        "paper": "all 156",
        "unit": "",
        "covers": ((156, 156),),
    }
    return [
        Claim(
            id="cases_at_10_s",
            claim="Cases of M and V_lp, of 156, on the side of V_c(M) where eq. 10 puts them, 10 s "
            "after a step from 0.1 mm/s; unstable: the last oscillation of tau/sigma exceeds "
            f"{UNSTABLE:g}.",
            converged=(counts[0],),
            error=abs(counts[0] - counts[1]),
            error_from=f"difference between rtol {RTOL[0]:g} and {RTOL[1]:g}",
            scheme=scheme,
            note=f"No case is undecided: below V_c the largest oscillation left is {below:.1e}, "
            f"above it the smallest is {least:.1e}. Of the scheme's finer step only the cases were "
            f"run that its large step puts on the wrong side ({repeated}).",
            **common,
        ),
        Claim(
            id="cases_converged",
            claim="The same of the converged motion: a limit cycle above V_c(M), none below.",
            note="Reached from steady sliding at V_lp/10.",
            **common,
            **pair(cycles),
        ),
    ]


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
