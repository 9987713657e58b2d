"""Warnings of what a slider leaves out, though its record shows it: a spring, a lag, inertia."""

from pathlib import Path

import numpy as np

from ....model.sentences import Sentences
from ..forward import Forward
from ..score import FALL, gain_of

#: K over normal stress [1/m] with which the effect of a spring is tried: of soft to stiff machines
STIFFNESSES = (1e3, 1e4, 1e5)
#: eta of the mass with which the effect of inertia is tried
LIGHT = 1e-3
#: largest mass per area of the contact that a machine moves [kg/m^2]: that of 100 m of steel, which
#: is ten times as much as the pistons of the largest ones, on a contact a tenth of their section
HEAVIEST = 7850.0 * 100.0
SENTENCES = Sentences(Path(__file__).with_suffix(".toml"))


def left_out(solution):
    """Warnings (iterator of str) that a lag or inertia would lower chi-square beyond chance."""
    yield from _later_or_earlier(solution)
    yield from _inert(solution)


def rigid(solution):
    """A warning (iterator of str) if a spring, where K = inf was given, would lower chi-square."""
    problem, slider = solution.problem, solution.problem.slider
    if np.isfinite(slider.K):
        return
    gains = [0.0]
    for stiffness in STIFFNESSES:
        sprung = slider.replace(K=stiffness * slider.sigma, M=0.0)
        forward = Forward(problem.record, sprung, solution.unknowns.names)
        friction = forward.friction(solution.point[None])[0]
        if np.isfinite(friction).all():  # else it is too soft to slide through the record
            gain, (part,) = gain_of(solution, (friction - solution.fitted_friction)[:, None])
            gains += [gain] if part > 0.0 else []
    if max(gains) > FALL:
        yield SENTENCES("more.stiffness", gain=max(gains))


def _later_or_earlier(solution):
    """A warning if a lag would lower chi-square by more than chance does."""
    problem, names = solution.problem, solution.unknowns.names
    if "lag" in names:
        return
    forward = Forward(problem.record, problem.slider, (*names, "lag"))
    step = forward.steps["lag"]
    points = np.array([np.append(solution.point, lag) for lag in (step, -step)])
    above, below = forward.friction(points)
    gain, (lag,) = gain_of(solution, np.nan_to_num((above - below) / (2.0 * step))[:, None])
    if gain > FALL:
        yield SENTENCES(
            "more.lag", lag=abs(lag), side="later" if lag > 0.0 else "earlier", gain=gain
        )


def _inert(solution):
    """A warning if inertia, which was left out, would lower chi-square by more than chance does.

    Where it takes a mass that no machine has, something else is wrong, and nothing is said.
    """
    problem, slider = solution.problem, solution.problem.slider
    if slider.M != 0.0 or not np.isfinite(slider.K):
        return
    at = problem.forward.values(solution.point[None])
    unit = float(at["a"][0] * slider.sigma * at["Dc"][0]) / problem.record.loading.V.max() ** 2
    massive = slider.replace(M=LIGHT * unit)
    heavy = Forward(problem.record, massive, solution.unknowns.names)
    friction = heavy.friction(solution.point[None])[0]
    by_eta = np.nan_to_num((friction - solution.fitted_friction) / LIGHT)
    gain, (eta,) = gain_of(solution, by_eta[:, None])
    if gain > FALL and eta > LIGHT and eta * unit < HEAVIEST:
        yield SENTENCES("more.inertia", gain=gain, unit=unit)
