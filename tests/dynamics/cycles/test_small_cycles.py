"""Soft limit cycles against 60-digit harmonic balance, SciPy, and the law of their birth."""

import mpmath
import numpy as np
import pytest
from dimensionless import rates
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from ratestate.dynamics.cycles.small_cycles import curvature, small_cycle
from ratestate.paper.figures import LAWS

laws = st.sampled_from(sorted(LAWS))


def at_margin_of(r, law, beta, eta):
    """Arguments of small_cycle whose cycle has this amplitude to leading order."""
    beta, eta = np.atleast_1d(beta, eta)
    margin = curvature(law, beta, eta) * r**2
    return law, (beta - 1) * (1 + eta) + margin, beta, eta, margin


def integrated(law, kappa, beta, eta, psi, G, period):
    """State and stress extremes after this time, by DOP853 from the section."""

    def v(T, y):
        return y[1]

    start, f = [beta * psi + eta * G, 0.0, psi], rates(law, kappa, beta, eta)
    settings = {"rtol": 3e-14, "atol": 1e-16, "events": v}
    run = solve_ivp(lambda T, y: f(y), (0, period), start, "DOP853", **settings)
    x, v_end, psi_end = run.y[:, -1]
    stress = [start[0], *run.y_events[0][:, 0]]
    return np.array([v_end, psi_end, (x - beta * psi_end) / eta]), max(stress) - min(stress)


@settings(max_examples=10, deadline=None)
@given(laws, st.floats(-1, 1), st.floats(-1, 1), st.floats(0.02, 0.15))
def test_closes_after_a_period(law, log_b1, log_eta, r):
    arguments = at_margin_of(r, law, 1 + 10**log_b1, 10**log_eta)
    cycle = small_cycle(*arguments)
    if not cycle.valid[0]:  # by a fold of the aging law
        assert abs(arguments[-1][0]) < 0.02 * r**2
        return
    psi, G = cycle.psi[0], cycle.G[0]
    parameters = (value[0] for value in arguments[1:4])
    end, amplitude = integrated(law, *parameters, psi, G, 2 * np.pi / cycle.omega[0])
    np.testing.assert_allclose(end, [0, psi, G], rtol=0, atol=3e-12 * max(1, G))
    assert amplitude == pytest.approx(cycle.amplitude[0], rel=1e-10)


def precise_cycle(law, r, beta, eta):
    """Margin, omega, psi, G and amplitude at amplitude r: collocation as it stands, in 60 digits.

    With three harmonics its own error is r^3.
    """
    mp = mpmath.MPContext()
    mp.dps = 60
    n, r, beta, eta = 7, mp.mpf(r), mp.mpf(beta), mp.mpf(eta)

    def waves(phase):
        return [mp.mpf(1), *(f(k * phase) for k in (1, 2, 3) for f in (mp.cos, mp.sin))]

    def slopes(phase):
        return [0, *(f for k in (1, 2, 3) for f in (-k * mp.sin(k * phase), k * mp.cos(k * phase)))]

    nodes = [(waves(t), slopes(t)) for t in (2 * mp.pi * j / n for j in range(n))]

    def split(q):
        kappa, omega = q[n + 1 : n + 3]  # in the place of v's fundamental, which is r cos
        return q[:n], [q[n], r, 0, *q[n + 3 : 2 * n]], q[2 * n :], kappa, omega

    def equations(*q):
        x, v, psi, kappa, omega = split(q)
        left = []
        for wave, slope in nodes:
            x_, v_, psi_ = (mp.fdot(c, wave) for c in (x, v, psi))
            w = mp.exp(v_)
            rate = -w * (v_ + psi_) if law == "slip" else mp.exp(-psi_) - w
            left.append(omega * mp.fdot(x, slope) - kappa * (1 - w))
            left.append(omega * mp.fdot(v, slope) * eta * w - (x_ - v_ - beta * psi_))
            left.append(omega * mp.fdot(psi, slope) - rate)
        return left

    omega, zero = mp.sqrt(beta - 1), mp.mpf(0)
    x = [zero, zero, -r * omega * (1 + eta), *[zero] * 4]
    v = [zero, (beta - 1) * (1 + eta), omega, *[zero] * 4]
    psi = [zero, -r / beta, -r * omega / beta, *[zero] * 4]
    q = mp.findroot(equations, x + v + psi, tol=mp.mpf(10) ** -90)
    x, v, psi, kappa, omega = split(list(q))
    rising, falling = (
        mp.findroot(lambda t: mp.fdot(v, waves(t)), side * mp.pi / 2) for side in (-1, 1)
    )
    section = mp.fdot(psi, waves(rising)), omega * mp.fdot(v, slopes(rising))
    amplitude = mp.fdot(x, waves(rising)) - mp.fdot(x, waves(falling))
    return [float(f) for f in (kappa - (beta - 1) * (1 + eta), omega, *section, amplitude)]


@pytest.mark.parametrize(
    ("law", "r", "beta", "eta"),
    [
        ("aging", 1e-8, 1.7, 0.3),
        ("slip", 1e-6, 3.0, 1e6),
        ("aging", 1e-5, 40.0, 1e-4),
        ("slip", 1e-5, 2.0, 1e-5),
    ],
)
def test_small_cycles_keep_all_digits_at_any_size(law, r, beta, eta):
    margin, *theirs = precise_cycle(law, r, beta, eta)
    cycle = small_cycle(law, (beta - 1) * (1 + eta) + margin, beta, eta, margin)
    assert curvature(law, beta, eta)[0] * r**2 == pytest.approx(margin, rel=1e-8, abs=0)
    assert cycle.valid[0]
    error = cycle.error[0]
    cancelling = np.sqrt((beta - 1) * beta) * (1 + eta) * r**2 / abs(margin)
    assert 2e-16 < error < 3e-15 * (1 + cancelling)
    assert cycle.r[0] == pytest.approx(r, rel=error, abs=0)
    ours = [cycle.omega[0], cycle.psi[0], cycle.G[0], cycle.amplitude[0]]
    np.testing.assert_allclose(ours, theirs, rtol=error + 3e-15)


def test_the_error_includes_cancellation():
    exact = small_cycle("slip", 4.0 - 1e-11, 2.0, 3.0, -1e-11)
    blurred = small_cycle("slip", 4.0 - 1e-11, 2.0, 3.0)
    assert exact.error[0] < 1e-14
    assert 3e-5 < blurred.error[0] < 3e-4
    assert 0 < abs(blurred.r[0] / exact.r[0] - 1) < blurred.error[0]


@settings(max_examples=15, deadline=None)
@given(
    laws,
    st.floats(-6, 2),
    st.floats(-14, 14),
    st.floats(-320, 1),
    st.sampled_from([-1, 0, 1]),
    st.booleans(),
)
def test_any_slider_has_finite_numbers_or_none(
    law, log_b1, log_eta, log_margin, sign, given_margin
):
    beta, eta = 1 + 10**log_b1, 10**log_eta
    critical = (beta - 1) * (1 + eta)
    margin = max(sign * 10**log_margin, -0.99) * critical
    cycle = small_cycle(law, critical + margin, beta, eta, margin if given_margin else None)
    if cycle.valid[0]:
        assert all(np.isfinite(value[0]) and value[0] > 0 for value in cycle[1:])
        assert cycle.r[0] <= 0.3
        assert cycle.error[0] <= 1e-3
    else:
        assert all(np.isnan(value[0]) for value in cycle[1:])


@settings(max_examples=10, deadline=None)
@given(laws, st.floats(-6, 2), st.floats(-6, 14), st.floats(-8, -1.5))
def test_cycles_of_known_size_are_found(law, log_b1, log_eta, log_r):
    arguments = at_margin_of(10**log_r, law, 1 + 10**log_b1, 10**log_eta)
    _, _, beta, eta, margin = arguments
    relative = np.abs(margin[0]) / (10 ** (2 * log_r) * (beta[0] - 1) * eta[0])
    if law == "aging" and relative < 0.02:  # the curvature nearly vanishes
        return
    cycle = small_cycle(*arguments)
    assert cycle.valid[0]
    assert cycle.r[0] == pytest.approx(10**log_r, rel=0.1 + cycle.error[0])
