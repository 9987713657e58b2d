"""Claims on slow stick-slip: Fig. 6 and section 4.1."""

import math
from typing import Any

from ..dynamics.cycles.limit_cycle import limit_cycle
from ..dynamics.simulation.simulate import simulate
from ..model.loading import Loading
from .claim import Claim, exact, pair, to_digits
from .parameters import FIG4, FIG4_EXAMPLES, FIG6, FIG6_SPEEDS
from .scheme_map import FINER, LARGEST, METHOD, step_response, time_step

SETTLED = 300.0  # s in which Fig. 6 settles by the scheme
FIRST = 1.0  # s after the step of Fig. 6 that hold its first drop


def on_slow_slip(law):
    """The claims of Fig. 6."""
    slider = FIG6.replace(law=law)
    slow, fast = FIG6_SPEEDS
    step = (LARGEST, time_step(slider, LARGEST))
    settled = step_response(slider, slow, fast, SETTLED, LARGEST, METHOD[law], FIRST)
    fastest = float(limit_cycle(FIG4.replace(law=law), FIG4_EXAMPLES["stick_slip"]).V_max)

    def cycle(rtol):
        return limit_cycle(slider, fast, rtol=rtol)

    def first_drop(rtol):
        run = simulate(slider, Loading.constant(fast), FIRST, V_start=slow, rtol=rtol)
        return (_relative_inertia(run, slider),)

    common: dict[str, Any] = {"where": "sec. 4.1, Fig. 6", "unit": ""}
    inertia: dict[str, Any] = {"paper": "insignificant", "covers": ((0.0, 0.05),)}
    return [
        Claim(
            id="eta_fig6",
            claim="eta at 0.2 mm/s.",
            paper="0.002",
            covers=(to_digits(0.002, 0.001),),
            **common,
            **exact(slider.eta(fast)),
        ),
        Claim(
            id="K_over_K_c_fig6",
            claim="K/K_c at 0.2 mm/s, for K = 1.0005 K_c_qs.",
            paper="0.9985",
            covers=(to_digits(0.9985, 0.0001),),
            **common,
            **exact(slider.K / slider.K_c(fast)),
        ),
        Claim(
            id="slow_cycle",
            claim="There stick-slip appears: amplitude of the limit cycle of tau/sigma.",
            paper="a lasting cycle",
            covers=((1e-4, math.inf),),
            scheme={step: (float(settled.amplitude),)},
            note="So near K_c the scheme's anti-damping counts much; the paper's amplitude is in "
            "its figure only.",
            **common,
            **pair(lambda rtol: (float(cycle(rtol).amplitude),)),
        ),
        Claim(
            id="slow_slip",
            claim="Its slip is far slower than that of stick-slip in Fig. 4b: ratio of the largest "
            "velocities.",
            paper="much slower",
            covers=((0.0, 0.1),),
            scheme={step: (float(settled.V.max()) / fastest,)},
            **common,
            **pair(lambda rtol: (float(cycle(rtol).V_max) / fastest,)),
        ),
        Claim(
            id="slow_inertia",
            claim="Inertia is insignificant in it, in the drop too: largest |tau/sigma - mu| over "
            "the amplitude of the limit cycle.",
            scheme={step: (_relative_inertia(settled, slider),)},
            **common,
            **inertia,
            **pair(lambda rtol: (float(cycle(rtol).inertia),)),
        ),
        Claim(
            id="first_drop_inertia",
            claim="Inertia is insignificant in the whole run: the same in the first second after "
            "the step, which holds the first drop.",
            scheme={
                (od, time_step(slider, od)): (
                    _relative_inertia(
                        step_response(slider, slow, fast, FIRST, od, METHOD[law], FIRST), slider
                    ),
                )
                for od in (LARGEST, FINER)
            },
            note="Not the scheme's doing: the step by a factor 20 sets off one fast slip, of some "
            "10 ms, that a plot over seconds hides; the cycles it decays to are slow.",
            **common,
            **inertia,
            **pair(first_drop),
        ),
    ]


def _relative_inertia(run, slider):
    """Largest |tau/sigma - mu| over max - min of tau/sigma."""
    stress = run.tau / slider.sigma
    return float(abs(stress - run.mu).max() / (stress.max() - stress.min()))
