"""The claims table: where each claim of the paper stands, by its own scheme and converged."""

from ..friction.laws import evolution_law
from . import claims_cycles, claims_friction, claims_map, claims_regimes, claims_slow, claims_steps

#: Where the rows come from, in the order of the paper.
PARTS = [
    claims_friction.on_friction,
    claims_steps.on_steps,
    claims_map.on_map,
    claims_cycles.on_cycles,
    claims_regimes.on_regimes,
    claims_slow.on_slow_slip,
]


def claims(law="slip"):
    """Check the claims of the paper.

    Parameters
    ----------
    law : {"slip", "aging"}
        The paper's text, and all of its numbers, are about the slip law; what it says in words
        is put to the aging law too, with which its supplement repeats runs.

    Returns
    -------
    list of ratestate.paper.claim.Claim

    Raises
    ------
    ParameterError
        An unknown law.
    """
    evolution_law(law)
    return [row for part in PARTS for row in part(law)]
