"""The claims table: where each claim of the paper stands, by its own scheme and converged."""

from ..friction.laws import evolution_law
from . import claims_cycles, claims_regimes, claims_steps
from .claim import claim, statements

#: what measures the claims: functions of a law that give id -> what `claim` takes
MEASUREMENTS = [
    claims_steps.on_friction,
    claims_steps.on_steps,
    claims_steps.on_map,
    claims_cycles.on_cycles,
    claims_regimes.on_regimes,
    claims_regimes.on_slow_slip,
]


def claims(law="slip", measurements=MEASUREMENTS):
    """Check the claims of the paper, in its order: list of `Claim`, for all or some measurements.

    The paper's text, and all of its numbers, are about the slip law; what it says in words is put
    to the aging law too, with which its supplement repeats runs.
    """
    evolution_law(law)  # an unknown one is refused
    measured = {name: row for measure in measurements for name, row in measure(law).items()}
    order = list(statements())
    return [claim(name, law, measured[name]) for name in sorted(measured, key=order.index)]
