"""Claims on slow stick-slip: Fig. 6 and section 4.1."""

from ..dynamics.cycles.limit_cycle import limit_cycle
from ..dynamics.simulation.simulate import simulate
from ..model.loading import Loading
from .claim import exact, pair
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

    drops = {
        (od, time_step(slider, od)): (
            _relative_inertia(
                step_response(slider, slow, fast, FIRST, od, METHOD[law], FIRST), slider
            ),
        )
        for od in (LARGEST, FINER)
    }
    return {
        "eta_fig6": exact(slider.eta(fast)),
        "K_over_K_c_fig6": exact(slider.K / slider.K_c(fast)),
        "slow_cycle": pair(lambda rtol: (float(cycle(rtol).amplitude),))
        | {"scheme": {step: (float(settled.amplitude),)}},
        "slow_slip": pair(lambda rtol: (float(cycle(rtol).V_max) / fastest,))
        | {"scheme": {step: (float(settled.V.max()) / fastest,)}},
        "slow_inertia": pair(lambda rtol: (float(cycle(rtol).inertia),))
        | {"scheme": {step: (_relative_inertia(settled, slider),)}},
        "first_drop_inertia": pair(first_drop) | {"scheme": drops},
    }


def _relative_inertia(run, slider):
    """Largest |tau/sigma - mu| over max - min of tau/sigma."""
    stress = run.tau / slider.sigma
    return float(abs(stress - run.mu).max() / (stress.max() - stress.min()))
