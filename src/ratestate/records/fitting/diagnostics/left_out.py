"""Warnings on a spring, lag or inertia that a record shows and the slider lacks."""

import numpy as np

from ...messages import fitting as sentences
from ..forward import Forward
from ..generalized_least_squares import FALL, chi2_gain

#: values of K/sigma [1/m] that are tried, from soft to stiff machines
STIFFNESSES = (1e3, 1e4, 1e5)
#: shortest and longest lag that are tried: per sample spacing, and per duration of the record
SHORTEST, LONGEST = 0.5, 1.0 / 30.0
#: eta with which the effect of inertia is tried
LIGHT = 1e-3
#: largest mass of a machine per area of the contact [kg/m^2], that of 100 m of steel: ten times the
#: length of the largest pistons, on a contact of a tenth of their section
HEAVIEST = 7850.0 * 100.0


def left_out(solution):
    """Yield warnings if a lag or inertia would lower chi-square beyond chance."""
    yield from _lag_warning(solution)
    yield from _inertia_warning(solution)


def rigid_machine(solution):
    """Yield a warning if K = inf was given and a spring or a lag would fit better.

    If a spring does, the warning names the load point as well.  Seen from the poor fit of a rigid
    machine, a load point that moves later or more gradually explains as much.
    """
    if np.isfinite(solution.problem.slider.K):
        return
    gain = max(_gains_of_springs(solution))
    if gain > FALL:
        yield sentences("rigid.sprung", gain=gain)
    elif "lag" not in solution.unknowns.names:
        # a record may be too short for any lag
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
    """Return friction (m,) of another slider at the coordinates of a solution."""
    forward = Forward(solution.problem.record, slider, solution.unknowns.names)
    return forward.friction(solution.point[None])[0]


def _gains_of_lags(solution):
    """Yield the fall of chi-square by a lag, and the lag [s], for several lags.

    Friction of a rigid machine jumps, and so has no derivative by the lag.
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
    """Return the fall of chi-square by part of this change; 0 if NaN or negative."""
    if not np.isfinite(friction).all():  # a spring too soft to slide through the record
        return 0.0
    gain, (part,) = chi2_gain(solution, (friction - solution.fitted_friction)[:, None])
    return gain if part > 0.0 else 0.0


def _lag_warning(solution):
    """Yield a warning if a lag would lower chi-square by more than chance does."""
    problem, names = solution.problem, solution.unknowns.names
    if "lag" in names or not np.isfinite(problem.slider.K):  # see `rigid_machine`
        return
    forward = Forward(problem.record, problem.slider, (*names, "lag"))
    step = forward.steps["lag"]
    points = np.array([np.append(solution.point, lag) for lag in (step, -step)])
    above, below = forward.friction(points)
    gain, (lag,) = chi2_gain(solution, np.nan_to_num((above - below) / (2.0 * step))[:, None])
    if gain > FALL:
        yield sentences(
            "more.lag", lag=abs(lag), side="later" if lag > 0.0 else "earlier", gain=gain
        )


def _inertia_warning(solution):
    """Yield a warning if inertia would lower chi-square by more than chance does.

    There is no warning if this requires a mass that no machine has: then something else is wrong.
    """
    problem, slider = solution.problem, solution.problem.slider
    if slider.M != 0.0 or not np.isfinite(slider.K):
        return
    at = problem.forward.values(solution.point[None])
    unit = float(at["a"][0] * slider.sigma * at["Dc"][0]) / problem.record.loading.V.max() ** 2
    friction = _friction_of(slider.replace(M=LIGHT * unit), solution)
    by_eta = np.nan_to_num((friction - solution.fitted_friction) / LIGHT)
    gain, (eta,) = chi2_gain(solution, by_eta[:, None])
    if gain > FALL and eta > LIGHT and eta * unit < HEAVIEST:
        yield sentences("more.inertia", gain=gain, unit=unit)
