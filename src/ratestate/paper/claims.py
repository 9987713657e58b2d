"""The claims table: where each claim of the paper stands, by its own scheme and converged."""

from . import claims_cycles, claims_friction, claims_regimes, claims_slow, claims_steps

#: Where the rows come from, in the order of the paper.
PARTS = [
    claims_friction.on_friction,
    claims_steps.on_steps,
    claims_cycles.on_cycles,
    claims_regimes.on_regimes,
    claims_slow.on_slow_slip,
]


def claims(law="slip", progress=None):
    """Check the claims of the paper.

    Parameters
    ----------
    law : {"slip", "aging"}
        The paper's text is about the slip law; its supplement repeats the runs with the aging
        law, of which the text gives no numbers.
    progress : callable, optional
        Called with the fraction done.

    Returns
    -------
    list of ratestate.paper.claim.Claim

    Raises
    ------
    ParameterError
        An unknown law.
    """
    rows = []
    for i, part in enumerate(PARTS):
        rows += part(law)
        if progress is not None:
            progress((i + 1) / len(PARTS))
    return rows
