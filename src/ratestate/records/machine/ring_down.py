"""Free oscillations of stress after a step, a hold or a stress drop, and mass and damping.

The curve c0 + c1 t + exp(-decay t) (A cos omega t + B sin omega t) is fitted to the stress by least
squares.  The four linear coefficients are eliminated (variable projection: Golub & Pereyra 1973
doi:10.1137/0710036).  If the oscillation's speed is not small compared to the sliding speed, it has
harmonics.  Its beginning is left out until they are not significant.

A small oscillation exp(lambda t) of stress about steady sliding at V obeys

    M lambda^2 + (damping + G(lambda)) lambda + K = 0,
    G = (sigma/V) (a - b/(1 + lambda Dc/V)),

with G the friction of a law with one state (as in friction/closed_forms.py, with lambda in 1/s).
The imaginary part of this equation gives M, and its real part gives the damping, without further
approximation.  Without a slider G is 0: then M = K/|lambda|^2, and the damping includes friction.
"""

from typing import NamedTuple

import numpy as np
import scipy

from ..kit.noise import Noise, RestrictedLikelihood, estimated_noise
from ..kit.regression import central_differences, fall_of_chi2, generalized_least_squares

#: samples of the shortest window, ratio of a window to the one before, samples of the longest one
SHORTEST, GROWTH, LONGEST = 32, 2, 16384
#: fewest periods in a window, fewest samples of a period, least spectral peak over the median
PERIODS, SAMPLES, PEAK = 2.0, 5.0, 60.0
#: in decay times: length of a fit; time left out in one trial.  Most trials.  Further delays of the
#: start, in decay times, the first that works being used
DECAYS, LEFT_OUT, TRIALS, LATER = 5.0, 0.25, 24, (1.5, 1.0, 0.5)
#: fall of chi-square by harmonics (four coefficients) that 1 of 1000 fits exceeds by chance
SIGNIFICANT = 18.47
#: least ratio of omega, and of decay, to its error; largest ratio of decay to omega
RESOLVED, OVERDAMPED = 5.0, 0.7
#: relative error of omega and decay that is added if the oscillation is too short for a delay
UNCHECKED = 1e-3
#: relative steps of differences: in a fit, and of mass and damping
STEP, STEP_OF_MASS = 1e-5, 1e-6


class RingDown(NamedTuple):
    """A damped oscillation."""

    point: np.ndarray  # (2,) omega of the damped oscillation [rad/s], and decay [1/s]
    covariance: np.ndarray  # (2, 2) covariance of omega and decay
    rows: np.ndarray  # fitted samples
    fitted: np.ndarray  # fitted friction of these rows
    harmonics: float  # fall of chi-square by harmonics
    start: float = np.nan  # time of the step or stress drop before [s]
    V: float = np.nan  # load-point speed [m/s]

    @property
    def is_resolved(self):
        """Return whether omega and decay are significantly different from 0."""
        return bool((self.point > RESOLVED * np.sqrt(np.diag(self.covariance))).all())


def ring_down(t, friction, rows, V):
    """Return the `RingDown` in rows after a step or stress drop, at a speed V, or None."""
    first = _dominant_frequency(t, friction, rows)
    if first is None:
        return None
    omega, part = first
    window = rows[: LONGEST + np.searchsorted(rows, part[0])]
    fit = _fit_without_harmonics(t, friction, window, omega, 2.0 / float(t[part[-1]] - t[part[0]]))
    if fit is None:
        return None
    # nonlinear effects decrease as the square of the amplitude, so a later start is better
    for decays in LATER:
        begin = t[fit.rows[0]] + decays / fit.point[1]
        refit = _fit(t, friction, window, begin, *fit.point)
        if refit is not None and refit.is_resolved:
            return refit._replace(start=float(t[rows[0]]), V=V)
    unknown = np.diag((UNCHECKED * fit.point) ** 2)
    return fit._replace(covariance=fit.covariance + unknown, start=float(t[rows[0]]), V=V)


def _fit_without_harmonics(t, friction, rows, omega, decay):
    begin = t[rows[0]]
    spacing = float(np.median(np.diff(t[rows])))
    for _ in range(TRIALS):
        fit = _fit(t, friction, rows, begin, omega, decay)
        if fit is None:
            return None
        omega, decay = fit.point
        if not 0.0 < decay < OVERDAMPED * omega or omega * spacing * SAMPLES > 2.0 * np.pi:
            return None
        if fit.harmonics < SIGNIFICANT:
            return fit if fit.is_resolved else None
        begin += max(LEFT_OUT / decay, np.pi / omega)
    return None


def _dominant_frequency(t, friction, rows):
    """Return omega [rad/s] and rows of the window with the clearest spectral peak, or None."""
    windows, size = [], SHORTEST
    while size <= min(rows.size, LONGEST):
        part = rows[:size]
        u = np.linspace(-1.0, 1.0, size)
        smooth = np.polynomial.Polynomial.fit(u, friction[part], 3)
        power = np.abs(np.fft.rfft((friction[part] - smooth(u)) * np.hanning(size))) ** 2
        at = int(np.argmax(power))
        median = float(np.median(power[1:]))
        if at >= PERIODS + 1 and power[at] > PEAK * median:
            omega = 2.0 * np.pi * at / float(t[part[-1]] - t[part[0]])
            windows.append((power[at] / (power.sum() - power[at - 1 : at + 2].sum()), omega, part))
        size *= GROWTH
    return None if not windows else max(windows, key=lambda window: window[0])[1:]


def _basis(t, omega, decay):
    """Return the basis functions (n, 4) of friction; t is 0 at the window's start."""
    fall = np.exp(-decay * t)
    line = np.ones_like(t), t / t[-1]
    return np.column_stack([*line, fall * np.cos(omega * t), fall * np.sin(omega * t)])


def _fit(t, friction, rows, begin, omega, decay):
    """Fit a `RingDown` to rows from a time on, over `DECAYS` decay times; None if too few.

    omega, decay : starting values
    """
    rows_of_fit = rows[(t[rows] >= begin) & (t[rows] <= begin + DECAYS / decay)]
    if rows_of_fit.size < SHORTEST or (t[rows_of_fit[-1]] - begin) * omega < PERIODS * 2.0 * np.pi:
        return None
    at, y = t[rows_of_fit] - t[rows_of_fit[0]], friction[rows_of_fit] - friction[rows_of_fit].mean()
    noise, scale, point = Noise(float(y.std())), np.array([omega, decay]), np.ones(2)

    def residual(p):
        white = noise.whiten(at, np.column_stack([y, _basis(at, *(p * scale))]))[0]
        return white[:, 0] - white[:, 1:] @ np.linalg.lstsq(white[:, 1:], white[:, 0])[0]

    for _ in range(2):
        point = scipy.optimize.least_squares(residual, point, x_scale=[0.1, 0.5]).x
        p = point * scale
        columns = _basis(at, *p)
        linear, _ = generalized_least_squares(at, y, columns, noise)
        slopes = p * (linear @ central_differences(lambda q: _basis(at, *q), p, STEP * p))
        jacobian, rest = np.column_stack([slopes, columns]), y - columns @ linear
        noise, _ = estimated_noise(RestrictedLikelihood(at, rest, jacobian))
    white, _ = noise.whiten(at, jacobian)
    covariance = np.linalg.pinv(white.T @ white, rcond=1e-15)[:2, :2] * np.outer(p, p)
    # the effects of a larger oscillation: second harmonic, and shifts of level
    fall, turn = np.exp(-p[1] * at), 2.0 * p[0] * at
    effects = fall**2 * np.cos(turn), fall**2 * np.sin(turn), fall**2, fall
    harmonics = fall_of_chi2(at, rest, np.column_stack([jacobian, *effects]), 4, noise)
    return RingDown(p, covariance, rows_of_fit, friction[rows_of_fit] - rest, harmonics)


def mass_and_damping(K, ring_down, sigma, slider):
    """Return (M [kg/m^2], damping [Pa s/m]), and derivatives (2, 3) by omega, decay and K.

    slider : SpringSlider with a, b and Dc, or None for no friction
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
    """Return G [Pa s/m] of an oscillation exp(rate t); 0 at rest."""
    if slider is None or not V > 0.0:
        return 0j
    return sigma / V * (slider.a - slider.b / (1.0 + rate * slider.Dc / V))
