"""Free oscillations of stress after a step, a hold or a stress drop; mass and damping from them.

Stress is c0 + c1 t + exp(-decay t) (A cos omega t + B sin omega t), by least squares; the four
amplitudes are eliminated (variable projection: Golub & Pereyra 1973 doi:10.1137/0710036).  An
oscillation that is large beside the speed of sliding has harmonics: its beginning is left out until
they are not significant.

A small oscillation exp(lambda t) of stress about steady sliding at V obeys

    M lambda^2 + (damping + G(lambda)) lambda + K = 0,
    G = (sigma/V) (a - b/(1 + lambda Dc/V)),

with G the friction of a law with one state: numerics of `friction.stability`, with lambda in 1/s.
Its imaginary part gives M and its real part the damping, without further approximation.  Without a
slider G is 0: then M = K/|lambda|^2, and the damping has friction in it.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from ..kit.estimated_noise import estimated_noise
from ..kit.noise import Noise
from ..kit.regression import central_differences, fall_of_chi2, generalized_least_squares

#: shortest window that is searched, and a window over the one before; most samples of the longest
SHORTEST, GROWTH, LONGEST = 32, 2, 16384
#: fewest periods in a window; fewest samples of a period; peak of the spectrum over its median
PERIODS, SAMPLES, PEAK = 2.0, 5.0, 60.0
#: decay times that are fitted; those left out at a time, how often, and after that
DECAYS, LEFT_OUT, TIMES, LATER = 5.0, 0.25, 24, (1.5, 1.0, 0.5)
#: chi-square of the harmonics, which have four coefficients, that 1 of 1000 fits exceed
SIGNIFICANT = 18.47
#: least ratio of omega, and of decay, to its error; largest decay over omega
RESOLVED, OVERDAMPED = 5.0, 0.7
#: relative error of omega and decay that is added where the oscillation is too short to wait so
UNCHECKED = 1e-3
#: relative steps of differences: in a fit, and of mass and damping
STEP, STEP_OF_MASS = 1e-5, 1e-6


class RingDown(NamedTuple):
    """A damped oscillation."""

    point: np.ndarray  # (2,) omega [rad/s], of the damped oscillation, and decay [1/s]
    covariance: np.ndarray  # (2, 2) of these
    rows: np.ndarray
    fitted: np.ndarray  # friction of these rows
    harmonics: float  # fall of chi-square by them
    start: float = np.nan  # [s], of the step or stress drop before it
    V: float = np.nan  # load-point speed during it [m/s]

    @property
    def is_resolved(self):
        """Whether omega and decay are known well enough."""
        return bool((self.point > RESOLVED * np.sqrt(np.diag(self.covariance))).all())


def ring_down(t, friction, rows, V):
    """The `RingDown` in rows after a step or stress drop, at a speed V; None if there is none."""
    first = _dominant(t, friction, rows)
    if first is None:
        return None
    omega, part = first
    whole = rows[: LONGEST + np.searchsorted(rows, part[0])]
    fit = _linear_part(t, friction, whole, omega, 2.0 / float(t[part[-1]] - t[part[0]]))
    if fit is None:
        return None
    # what harmonics do not show yet falls with the square of the amplitude: so wait longer
    for decays in LATER:
        begin = t[fit.rows[0]] + decays / fit.point[1]
        again = _fit(t, friction, whole, begin, *fit.point)
        if again is not None and again.is_resolved:
            return again._replace(start=float(t[rows[0]]), V=V)
    unknown = np.diag((UNCHECKED * fit.point) ** 2)
    return fit._replace(covariance=fit.covariance + unknown, start=float(t[rows[0]]), V=V)


def _linear_part(t, friction, whole, omega, decay):
    """The first `RingDown` without significant harmonics, in what is left of the rows; or None."""
    begin = t[whole[0]]
    spacing = float(np.median(np.diff(t[whole])))
    for _ in range(TIMES):
        fit = _fit(t, friction, whole, begin, omega, decay)
        if fit is None:
            return None
        omega, decay = fit.point
        if not 0.0 < decay < OVERDAMPED * omega or omega * spacing * SAMPLES > 2.0 * np.pi:
            return None
        if fit.harmonics < SIGNIFICANT:
            return fit if fit.is_resolved else None
        begin += max(LEFT_OUT / decay, np.pi / omega)
    return None


def _dominant(t, friction, rows):
    """omega [rad/s] and rows of the window in which one frequency stands out most; None."""
    found, size = [], SHORTEST
    while size <= min(rows.size, LONGEST):
        part = rows[:size]
        u = np.linspace(-1.0, 1.0, size)
        smooth = np.polynomial.Polynomial.fit(u, friction[part], 3)
        power = np.abs(np.fft.rfft((friction[part] - smooth(u)) * np.hanning(size))) ** 2
        at = int(np.argmax(power))
        median = float(np.median(power[1:]))
        if at >= PERIODS + 1 and power[at] > PEAK * median:
            omega = 2.0 * np.pi * at / float(t[part[-1]] - t[part[0]])
            found.append((power[at] / (power.sum() - power[at - 1 : at + 2].sum()), omega, part))
        size *= GROWTH
    return None if not found else max(found, key=lambda one: one[0])[1:]


def _columns(t, omega, decay):
    """(n, 4) what friction is a linear function of, at times from the window's start on."""
    fall = np.exp(-decay * t)
    line = np.ones_like(t), t / t[-1]
    return np.column_stack([*line, fall * np.cos(omega * t), fall * np.sin(omega * t)])


def _fit(t, friction, whole, begin, omega, decay):
    """`RingDown` in rows from a time on, as long as it lasts; None if they are too few.

    omega, decay : from where the search starts
    """
    rows = whole[(t[whole] >= begin) & (t[whole] <= begin + DECAYS / decay)]
    if rows.size < SHORTEST or (t[rows[-1]] - begin) * omega < PERIODS * 2.0 * np.pi:
        return None
    at, y = t[rows] - t[rows[0]], friction[rows] - friction[rows].mean()
    noise, scale, point = Noise(float(y.std())), np.array([omega, decay]), np.ones(2)

    def residual(p):
        white = noise.whiten(at, np.column_stack([y, _columns(at, *(p * scale))]))[0]
        return white[:, 0] - white[:, 1:] @ np.linalg.lstsq(white[:, 1:], white[:, 0])[0]

    for _ in range(2):
        point = least_squares(residual, point, x_scale=[0.1, 0.5]).x
        p = point * scale
        columns = _columns(at, *p)
        linear = generalized_least_squares(at, y, columns, noise).coefficients
        slopes = p * (linear @ central_differences(lambda q: _columns(at, *q), p, STEP * p))
        jacobian, rest = np.column_stack([slopes, columns]), y - columns @ linear
        noise = estimated_noise(at, rest, jacobian)
    white, _ = noise.whiten(at, jacobian)
    covariance = np.linalg.pinv(white.T @ white, rcond=1e-15)[:2, :2] * np.outer(p, p)
    more = np.column_stack([jacobian, _harmonics(at, *p)])
    harmonics = fall_of_chi2(at, rest, more, 4, noise)
    return RingDown(p, covariance, rows, friction[rows] - rest, harmonics)


def _harmonics(t, omega, decay):
    """(n, 4) what a larger oscillation brings: the second harmonic, and two changes of level."""
    fall = np.exp(-2.0 * decay * t)
    waves = fall * np.cos(2.0 * omega * t), fall * np.sin(2.0 * omega * t)
    return np.column_stack([*waves, fall, np.exp(-decay * t)])


def mass_and_damping(K, ring_down, sigma, slider):
    """(M [kg/m^2], damping [Pa s/m]) of a `RingDown`, their derivatives (2, 3) by omega, decay, K.

    slider : its a, b and Dc, or None for no friction
    """

    def values(p):
        omega, decay, K = p
        rate = -decay + 1j * omega
        G = _friction(rate, ring_down.V, sigma, slider)
        per_K = 1.0 / abs(rate) ** 2
        M = K * per_K - G.imag / omega
        return np.array([M, M * decay + K * decay * per_K - G.real])

    point = np.append(ring_down.point, K)
    return values(point), central_differences(values, point, STEP_OF_MASS * point)


def _friction(rate, V, sigma, slider):
    """G [Pa s/m] of an oscillation exp(rate t); 0 at rest."""
    if slider is None or not V > 0.0:
        return 0j
    return sigma / V * (slider.a - slider.b / (1.0 + rate * slider.Dc / V))
