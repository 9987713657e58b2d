"""Which numbers of a fit need a profile, and all their profiles together."""

import numpy as np

from .profile import BEYOND, Profile, profile

#: root of the deviance that may differ by this part from a Gaussian's, two standard errors away
NEARLY = 0.1
#: rounds in which profiles that others contradict are made again
ROUNDS = 3


def gaussian(solution, numbers):
    """Whether the likelihood is Gaussian along each of these `Reported`: list of bool.

    Two standard errors to both sides, along the line on which the others follow the number, the
    deviance is compared with 4; what the others could still gain is taken off to second order.
    All is done by one batch of lanes.
    """
    point, spread, noise = solution.point, solution.covariance, solution.noise
    problem, t = solution.problem, solution.problem.record.t
    along = [spread @ number.gradient(point) for number in numbers]
    errors = [_error(solution, number) for number in numbers]
    steps = [2.0 * u / error for u, error in zip(along, errors, strict=True)]
    points = np.array([point + sign * step for step in steps for sign in (-1.0, 1.0)])
    sound = ((points > problem.unknowns.low) & (points < problem.unknowns.high)).all(axis=1)
    points[~sound] = point
    missing = problem.forward.friction(points) - problem.record.friction
    sound &= np.isfinite(missing).all(axis=1)
    missing[~sound] = 0.0
    white, _ = noise.whiten(t, np.column_stack([missing.T, solution.jacobian]))
    residuals, jacobian = white[:, : len(points)], white[:, len(points) :]
    slopes = jacobian.T @ residuals
    gain = np.einsum("ip,ij,jp->p", slopes, spread, slopes)
    root = np.zeros(len(points))
    for i, (number, u, error) in enumerate(zip(numbers, along, errors, strict=True)):
        for p in (2 * i, 2 * i + 1):
            # but for that part of the gain that would move the number itself
            kept = gain[p] - (u @ slopes[:, p] / error) ** 2
            deviance = residuals[:, p] @ residuals[:, p] - kept - solution.chi2
            moved = (number.value(points[p]) - number.value(point)) / error
            root[p] = np.sqrt(max(deviance, 0.0)) / max(abs(moved), 1e-9)
    close = sound & (np.abs(root - 1.0) < NEARLY)
    return [bool(both) for both in close.reshape(-1, 2).all(axis=1)]


def profiles(solution, numbers, everything):
    """name -> `Profile` of the numbers that need one, or of all.

    Where one number runs far, the others follow it: so each profile also starts from the fits of
    the others, and is made again where those fit better than its own.

    Raises
    ------
    Better
        A profile has found a point that fits better than the solution.
    """
    if everything:
        todo = list(numbers)
    else:
        straight = gaussian(solution, numbers)
        todo = [n for n, plain in zip(numbers, straight, strict=True) if not plain]
    found: dict[str, Profile] = {}
    known: list[tuple] = []
    for _ in range(ROUNDS):
        for number in todo:
            made = profile(solution, number, known)
            found[number.name] = made
            known += zip(made.points, made.deviance, strict=True)
        todo = [n for n in numbers if _contradicted(solution, n, found.get(n.name), known)]
        if not todo:
            break
    return found


def _contradicted(solution, number, made, known):
    """Whether a fit that is known has less deviance than a number's Gaussian, or profile, says."""
    values = np.array([number.value(point) for point, _ in known])
    roots = np.sqrt([deviance for _, deviance in known])
    likely = roots < BEYOND
    if made is None:
        claimed = np.abs(values - number.value(solution.point)) / _error(solution, number)
    else:
        # beyond its ends a profile claims as much as there
        claimed = np.abs(np.interp(values, made.values, made.root))
    return bool(np.any(likely & (roots < (1.0 - NEARLY) * claimed - NEARLY)))


def _error(solution, number):
    gradient = number.gradient(solution.point)
    return float(np.sqrt(gradient @ solution.covariance @ gradient))
