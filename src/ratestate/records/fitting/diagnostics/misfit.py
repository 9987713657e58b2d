"""Whether a law fits: residuals larger than the noise, or transients in them after the steps."""

from pathlib import Path

import numpy as np

from ....model.names import Sentences

#: size of the residuals, over that of a given noise, that contradicts it
CONTRADICTED = 1.5
#: probability below which such transients are not taken for noise
CHANCE = 0.01
#: the laws with two states, of the sum of two effects that one state cannot give
TWO_STATES = "two-state-aging or two-state-slip"
SENTENCES = Sentences(Path(__file__).with_suffix(".toml"))


def is_misfit(inference):
    """Whether residuals are larger than the noise given, or have transients after steps."""
    return _over_given(inference.solution) >= CONTRADICTED or inference.chance < CHANCE


def misfit_warnings(inference):
    """Warnings on residuals that are as `is_misfit` says."""
    solution = inference.solution
    if (ratio := _over_given(solution)) >= CONTRADICTED:
        yield SENTENCES("residuals.above_noise", ratio=ratio)
    if inference.chance < CHANCE:
        massless = solution.problem.forward.fixed["M"] == 0.0
        mass = "the machine's mass (M is 0), " if massless else ""
        values = {"chance": inference.chance, "mass": mass, "other": _other_law(solution)}
        yield SENTENCES("residuals.after_steps", **values)
    elif np.isnan(inference.chance):
        yield SENTENCES("residuals.not_tested")


def _over_given(solution):
    """Size of the residuals over that of the noise; about 1 where the noise was estimated."""
    return np.sqrt(solution.chi2 / solution.fitted_friction.size)


def _other_law(solution):
    """Which law to try where one does not fit: of one with one state those with two."""
    if len(solution.problem.law.states) > 1:
        return "another law"
    return f"another law, such as {TWO_STATES}"
