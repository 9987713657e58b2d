"""Claims on slow stick-slip: Fig. 6 and section 4.1."""

from ..dynamics.cycles.limit_cycle import limit_cycle
from ..dynamics.simulation.simulate import simulate
from ..model.loading import Loading
from .claim import by_scheme, exact, pair
from .parameters import FIG4, FIG4_EXAMPLES, FIG6, FIG6_SPEEDS
from .scheme_map import FINER, LARGEST, step_response

SETTLED = 300.0  # s in which Fig. 6 settles by the scheme
FIRST = 1.0  # s after the step of Fig. 6 that hold its first drop


def on_slow_slip(law):
    """The claims of Fig. 6."""
    slider = FIG6.replace(law=law)
    slow, fast = FIG6_SPEEDS
    fastest = float(limit_cycle(FIG4.replace(law=law), FIG4_EXAMPLES["stick_slip"]).V_max)

    def first_drop(rtol):
        run = simulate(slider, Loading.constant(fast), FIRST, V_start=slow, rtol=rtol)
        return _relative_inertia(run, slider)

    def first_drop_by_scheme(omega_dt):
        run = step_response(slider, slow, fast, FIRST, omega_dt, last=FIRST)
        return _relative_inertia(run, slider)

    settled = step_response(slider, slow, fast, SETTLED, LARGEST, last=FIRST)
    #: claim -> variable of the limit cycle; over what; the same by the scheme
    of_the_cycle = {
        "slow_cycle": ("amplitude", 1.0, settled.amplitude),
        "slow_slip": ("V_max", fastest, settled.V.max()),
        "slow_inertia": ("inertia", 1.0, _relative_inertia(settled, slider)),
    }

    def cycle(name, over, scheme):
        measured = pair(lambda rtol: limit_cycle(slider, fast, rtol=rtol)[name] / over)
        return measured | by_scheme(lambda omega_dt: scheme / over, slider, LARGEST)

    return {
        "eta_fig6": exact(slider.eta(fast)),
        "K_over_K_c_fig6": exact(slider.K / slider.K_c(fast)),
        **{name: cycle(*row) for name, row in of_the_cycle.items()},
        "first_drop_inertia": pair(first_drop)
        | by_scheme(first_drop_by_scheme, slider, LARGEST, FINER),
    }


def _relative_inertia(run, slider):
    """Largest |tau/sigma - mu| over max - min of tau/sigma."""
    stress = run.tau / slider.sigma
    return float(abs(stress - run.mu).max() / (stress.max() - stress.min()))
