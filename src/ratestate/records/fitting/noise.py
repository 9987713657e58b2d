"""The noise of a record: its level and correlation, given or estimated from the residuals.

The noise is white noise plus an Ornstein-Uhlenbeck process (engine/noise.py): the former is
from a load cell's digits and electronics, the latter from filters, gouge and machine.  Its three
numbers are estimated by restricted maximum likelihood, which allows for what the fitted
parameters have taken out of the residuals: Patterson & Thompson (1971)
doi:10.1093/biomet/58.3.545.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize

from ...engine.noise import whiten
from ...model.units import to_si
from .refusals import refusal

#: least rise of ln(likelihood) for correlated noise, which has two more parameters
RISE = 3.0


class Noise(NamedTuple):
    """Standard deviations of the white and the correlated part, and the latter's time [s]."""

    white: float
    red: float = 0.0
    time: float = 1.0

    def whiten(self, t, columns):
        """(n, k) columns at times t (n,) with white noise of unit variance; ln det(covariance)."""
        columns = np.ascontiguousarray(columns.T if columns.ndim > 1 else columns[None])
        if self.red == 0.0:
            out = columns / self.white
            log_determinant = 2.0 * t.size * math.log(self.white)
        else:
            out = np.empty_like(columns)
            arguments = (np.diff(t), self.white**2, self.red**2, self.time, columns, out)
            log_determinant = whiten(*arguments)
        return out.T, log_determinant

    @property
    def level(self):
        """Standard deviation of one sample."""
        return math.hypot(self.white, self.red)


def given_noise(noise):
    """The `Noise` that the user gives, or None if it is to be estimated.

    noise : None, a standard deviation of friction, or a dict of "white", "red" and "time"; else, or
        for "red" without "time", or neither above 0, a ParameterError
    """
    if noise is None:
        return None
    if not isinstance(noise, dict):
        return Noise(to_si("noise", noise))
    if not set(noise) <= {"white", "red", "time"} or not noise:
        raise refusal("noise.form", noise=noise)
    if "red" in noise and "time" not in noise:
        raise refusal("noise.no_time")
    white, red = (
        to_si("noise", noise.get(k, 0.0), label=f"noise {k}", bound=">= 0")
        for k in ("white", "red")
    )
    if not white + red > 0.0:
        raise refusal("noise.zero")
    return Noise(white, red, to_si("t", noise.get("time", 1.0), label="noise time", bound="> 0"))


def estimated_noise(t, residual, jacobian):
    """`Noise` by restricted maximum likelihood: of residuals (n,) with a fit's jacobian (n, k).

    White, unless a red part raises ln(likelihood) by more than `RISE`.  A column that is all 0, of
    what the record does not see, does not count.
    """
    jacobian = jacobian[:, jacobian.any(axis=0)]
    columns = np.column_stack([residual, jacobian / np.abs(jacobian).max(axis=0)])
    degrees = residual.size - jacobian.shape[1]
    lags = np.median(np.diff(t)), t[-1] - t[0]

    def shape(point):
        """Share of the correlated part in the variance, and its time."""
        share = 1.0 / (1.0 + math.exp(-point[0]))
        return share, math.exp(point[1])

    def criterion(share, time):
        """-ln(restricted likelihood) at the best variance, and that variance."""
        unit = Noise(math.sqrt(1.0 - share), math.sqrt(share), time)
        white, log_determinant = unit.whiten(t, columns)
        normal = white.T @ white
        try:
            factor = np.linalg.cholesky(normal[1:, 1:])
        except np.linalg.LinAlgError:  # the record does not see some parameter at all
            return math.inf, math.nan
        projected = np.linalg.solve(factor, normal[1:, 0])
        variance = max(normal[0, 0] - projected @ projected, 0.0) / degrees
        if not variance > 0.0:
            return math.inf, math.nan
        log_normal = 2.0 * np.log(np.diag(factor)).sum()
        return 0.5 * (degrees * math.log(variance) + log_determinant + log_normal), variance

    best, variance = criterion(0.0, 1.0)
    noise = Noise(math.sqrt(variance))
    low, high = math.log(0.2 * lags[0]), math.log(lags[1])
    for start in (2.0 * lags[0], 0.02 * lags[1]):
        first = np.array([0.0, min(max(math.log(start), low), high)])
        # (SciPy's own simplex about a coordinate of 0 is so thin that it may never move)
        simplex = first + np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
        result = minimize(
            lambda point: criterion(*shape(point))[0],
            first,
            method="Nelder-Mead",
            bounds=((-8.0, 14.0), (low, high)),
            options={"initial_simplex": simplex, "xatol": 0.02, "fatol": 0.01, "maxfev": 150},
        )
        if result.fun < best - (RISE if noise.red == 0.0 else 0.0):
            share, time = shape(result.x)
            variance = criterion(share, time)[1]
            best = result.fun
            noise = Noise(math.sqrt((1.0 - share) * variance), math.sqrt(share * variance), time)
    return noise
