"""Warnings of what a slider leaves out, though its record shows it: a spring, a lag, inertia."""

import numpy as np

from ...messages import fitting as sentences
from ..forward import Forward
from ..generalized_least_squares import FALL, gain_of

#: K over normal stress [1/m] with which the effect of a spring is tried: of soft to stiff machines
STIFFNESSES = (1e3, 1e4, 1e5)
#: lags that are tried: the shortest over the time from sample to sample, the longest over all time
SHORTEST, LONGEST = 0.5, 1.0 / 30.0
#: eta of the mass with which the effect of inertia is tried
LIGHT = 1e-3
#: largest mass per area of the contact that a machine moves [kg/m^2]: that of 100 m of steel, which
#: is ten times as much as the pistons of the largest ones, on a contact a tenth of their section
HEAVIEST = 7850.0 * 100.0


def left_out(solution):
    """Warnings (iterator of str) that a lag or inertia would lower chi-square beyond chance."""
    yield from _later_or_earlier(solution)
    yield from _inert(solution)


def rigid(solution):
    """A warning (iterator of str) of what, where K = inf was given, would lower chi-square.

    Where a spring does, both it and the load point are named: seen from the fit of a rigid machine,
    which is far off, a load point that moves later or more gradually explains as much.
    """
    if np.isfinite(solution.problem.slider.K):
        return
    gain = max(_gains_of_springs(solution))
    if gain > FALL:
        yield sentences("rigid.sprung", gain=gain)
    elif "lag" not in solution.unknowns.names:
        # (a short record may be too short for any lag)
        gain, lag = max(_gains_of_lags(solution), default=(0.0, 0.0))
        if gain > FALL:
            side = "later" if lag > 0.0 else "earlier"
            yield sentences("rigid.lag", lag=abs(lag), side=side, gain=gain)


def _gains_of_springs(solution):
    slider = solution.problem.slider
    for stiffness in STIFFNESSES:
        sprung = slider.replace(K=stiffness * slider.sigma, M=0.0)
        yield _gain(solution, _friction_of(sprung, solution))


def _friction_of(slider, solution):
    """(m,) friction of another slider at the coordinates of a solution."""
    forward = Forward(solution.problem.record, slider, solution.unknowns.names)
    return forward.friction(solution.point[None])[0]


def _gains_of_lags(solution):
    """Falls of chi-square by lags, and these [s] (iterator of pairs).

    Friction of a rigid machine jumps, and has no derivative by the lag: some are tried.
    """
    record = solution.problem.record
    octaves = np.arange(0.0, np.log2(LONGEST * record.t[-1] / (SHORTEST * record.spacing)), 0.5)
    lags = SHORTEST * record.spacing * 2.0**octaves
    lags = np.concatenate([lags, -lags])
    forward = Forward(record, solution.problem.slider, (*solution.unknowns.names, "lag"))
    points = np.column_stack([np.tile(solution.point, (lags.size, 1)), lags])
    for lag, friction in zip(lags, forward.friction(points), strict=True):
        yield _gain(solution, friction), float(lag)


def _gain(solution, friction):
    """Fall of chi-square by some of a change to this friction; 0 if it is NaN, or by less of it."""
    if not np.isfinite(friction).all():  # a spring too soft to slide through the record
        return 0.0
    gain, (part,) = gain_of(solution, (friction - solution.fitted_friction)[:, None])
    return gain if part > 0.0 else 0.0


def _later_or_earlier(solution):
    """A warning if a lag would lower chi-square by more than chance does."""
    problem, names = solution.problem, solution.unknowns.names
    if "lag" in names or not np.isfinite(problem.slider.K):  # `rigid` has tried it
        return
    forward = Forward(problem.record, problem.slider, (*names, "lag"))
    step = forward.steps["lag"]
    points = np.array([np.append(solution.point, lag) for lag in (step, -step)])
    above, below = forward.friction(points)
    gain, (lag,) = gain_of(solution, np.nan_to_num((above - below) / (2.0 * step))[:, None])
    if gain > FALL:
        yield sentences(
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
    friction = _friction_of(slider.replace(M=LIGHT * unit), solution)
    by_eta = np.nan_to_num((friction - solution.fitted_friction) / LIGHT)
    gain, (eta,) = gain_of(solution, by_eta[:, None])
    if gain > FALL and eta > LIGHT and eta * unit < HEAVIEST:
        yield sentences("more.inertia", gain=gain, unit=unit)
