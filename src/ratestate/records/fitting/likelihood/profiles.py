"""Which quantities of a fit need a profile, and all their profiles together."""

import numpy as np

from ..estimates import GAUSSIAN, ROOTS
from .profile import BEYOND, Profile, compute_profile

#: relative difference of the deviance's root from a Gaussian's that counts as Gaussian
TOLERANCE = 0.1
#: most rounds in which profiles that others contradict are computed again
ROUNDS = 3


def are_gaussian(solution, quantities):
    """Whether the likelihood is Gaussian along each `ReportedQuantity`: list of bool.

    Two standard errors to both sides, along the direction in which the other coordinates follow
    the quantity, the deviance is compared with 4.  The fall that moving the others could still
    achieve is subtracted to second order.  All points are one batch of lanes.  False where one is
    out of bounds, or has no motion.
    """
    point, spread, problem = solution.point, solution.covariance, solution.problem
    along = [spread @ quantity.gradient(point) for quantity in quantities]
    errors = [quantity.standard_error(point, spread) for quantity in quantities]
    steps = [2.0 * u / error for u, error in zip(along, errors, strict=True)]
    points = np.array([point + sign * step for step in steps for sign in (-1.0, 1.0)])
    sound = ((points > problem.unknowns.low) & (points < problem.unknowns.high)).all(axis=1)
    points[~sound] = point
    residuals = problem.forward.friction(points) - problem.record.friction
    sound &= np.isfinite(residuals).all(axis=1)
    residuals[~sound] = 0.0
    columns = np.column_stack([residuals.T, solution.jacobian])
    white, _ = solution.noise.whiten(problem.record.t, columns)
    whitened, jacobian = white[:, : len(points)], white[:, len(points) :]
    slopes = jacobian.T @ whitened
    gain = np.einsum("ip,ij,jp->p", slopes, spread, slopes)
    root = np.zeros(len(points))
    for i, (quantity, u, error) in enumerate(zip(quantities, along, errors, strict=True)):
        for p in (2 * i, 2 * i + 1):
            # without the part of the gain that would move the quantity itself
            gain_of_others = gain[p] - (u @ slopes[:, p] / error) ** 2
            deviance = whitened[:, p] @ whitened[:, p] - gain_of_others - solution.chi2
            moved = (quantity.value(points[p]) - quantity.value(point)) / error
            root[p] = np.sqrt(max(deviance, 0.0)) / max(abs(moved), 1e-9)
    close = sound & (np.abs(root - 1.0) < TOLERANCE)
    return [bool(both) for both in close.reshape(-1, 2).all(axis=1)]


def compute_profiles(solution, quantities, everything, roots=None):
    """name -> `Profile` of the quantities whose likelihood is not Gaussian, or of all.

    roots : (quantities, levels, sides) of the deviance, at the ends of intervals; by default those
        of a noise that is known

    Where one quantity goes far, the others follow it: so each profile also starts from the fits
    of the others, and is computed again where those fit better than its own.  `BetterPoint` is
    raised where one fits better than the solution.
    """
    left_out = [False] * len(quantities) if everything else are_gaussian(solution, quantities)
    roots = [GAUSSIAN] * len(quantities) if roots is None else roots
    roots_of = {q.name: own for q, own in zip(quantities, roots, strict=True)}
    todo = [q for q, is_left_out in zip(quantities, left_out, strict=True) if not is_left_out]
    profiles: dict[str, Profile] = {}
    fits: list[tuple] = []  # (point, deviance) of all profiles
    for _ in range(ROUNDS):
        for quantity in todo:
            profile = profiles[quantity.name] = compute_profile(
                solution, quantity, fits, roots_of[quantity.name]
            )
            fits += zip(profile.points, profile.deviance, strict=True)
        todo = [q for q in quantities if _contradicted(solution, q, profiles.get(q.name), fits)]
        if not todo:
            break
    return profiles


def _contradicted(solution, quantity, profile, fits):
    """Whether some fit has a smaller deviance than the quantity's profile, or Gaussian, there."""
    values = np.array([quantity.value(point) for point, _ in fits])
    roots = np.sqrt([deviance for _, deviance in fits])
    likely = roots < BEYOND * ROOTS[-1]
    if profile is None:
        error = quantity.standard_error(solution.point, solution.covariance)
        claimed = np.abs(values - quantity.value(solution.point)) / error
    else:
        # beyond its ends a profile claims as much as at them
        claimed = np.abs(np.interp(values, profile.values, profile.root))
    return bool(np.any(likely & (roots < (1.0 - TOLERANCE) * claimed - TOLERANCE)))
