"""Rodas5P: its tableau by algebra, one step against a plain one, observed orders."""

import functools

import mpmath
import numpy as np
import pytest
from machine_control import Formula
from naive import FIG2, Naive
from published_step import A, C, published_step

import ratestate as rs
from ratestate.engine import rodas5p as R
from ratestate.friction.laws import LAWS
from ratestate.friction.point import point_at

# Coefficients of the untransformed method (Hairer & Wanner 1996, IV.7), in 40 digits: residuals
# show the rounding of the tableau alone.
with mpmath.workdps(40):
    INVERSE = (mpmath.matrix(np.eye(8)) / mpmath.mpf(R.GAMMA) - mpmath.matrix(C)) ** -1
    EXACT = np.array(INVERSE.tolist())
GAMMAS = EXACT.astype(float)
ALPHAS = A[:8] @ GAMMAS
BETAS = ALPHAS + GAMMAS
NODES = ALPHAS.sum(1)


def order_conditions(weights, s=1.0):
    """Return residuals of the order conditions (H&W, table IV.7.1) by order.

    weights : of k_1 to k_8 in the new state; with s < 1, in the dense output at the fraction s
    """
    with mpmath.workdps(40):
        return _order_conditions(weights @ EXACT, mpmath.mpf(s))


def _order_conditions(b, s):
    al = A[:8] @ EXACT
    be = al + EXACT
    c, one = al.sum(1), be.sum(1)
    return {
        1: [b.sum() - s],
        2: [b @ one - s**2 / 2],
        3: [b @ c**2 - s**3 / 3, b @ be @ one - s**3 / 6],
        4: [
            b @ c**3 - s**4 / 4,
            b @ (c * (al @ one)) - s**4 / 8,
            b @ be @ c**2 - s**4 / 12,
            b @ be @ be @ one - s**4 / 24,
        ],
        5: [
            b @ c**4 - s**5 / 5,
            b @ (c**2 * (al @ one)) - s**5 / 10,
            b @ (al @ one) ** 2 - s**5 / 20,
            b @ (c * (al @ c**2)) - s**5 / 15,
            b @ (c * (al @ be @ one)) - s**5 / 30,
            b @ be @ c**3 - s**5 / 20,
            b @ be @ (c * (al @ one)) - s**5 / 40,
            b @ be @ be @ c**2 - s**5 / 60,
            b @ be @ be @ be @ one - s**5 / 120,
        ],
    }


def largest(conditions, *orders):
    return max(abs(residual) for order in orders for residual in conditions[order])


def test_nodes_and_drifts_are_row_sums():
    np.testing.assert_allclose(R.NODES, NODES, rtol=0, atol=1e-13)
    np.testing.assert_allclose(R.D, GAMMAS.sum(1), rtol=0, atol=2e-13)
    np.testing.assert_allclose(np.diag(GAMMAS), R.GAMMA, rtol=1e-14)


def test_order_conditions():
    assert largest(order_conditions(A[8]), 1, 2, 3, 4, 5) < 1e-14
    embedded = order_conditions(A[7])  # y_new - k_8
    assert largest(embedded, 1, 2, 3, 4) < 1e-14
    assert largest(embedded, 5) > 1e-4  # else the error estimate would say nothing


@pytest.mark.parametrize("s", [0.1, 0.37, 0.5, 0.9])
def test_order_conditions_of_dense_output(s):
    h1, h2, h3 = np.array(R.H)
    weights = s * A[8] + s * (1 - s) * (h1 + s * (h2 + s * h3))
    conditions = order_conditions(weights, s)
    assert largest(conditions, 1, 2, 3, 4) < 4e-14
    assert largest(conditions, 5) > 1e-6


def test_stiff_accuracy():
    np.testing.assert_allclose(BETAS[7], A[8] @ GAMMAS, rtol=0, atol=1e-13)
    np.testing.assert_allclose(BETAS[6], A[7] @ GAMMAS, rtol=0, atol=1e-13)
    np.testing.assert_allclose(NODES[5:], 1, atol=1e-14)
    # R(infinity) = 1 - b B^-1 1 = 0
    assert abs(1 - (A[8] @ GAMMAS) @ np.linalg.solve(BETAS, np.ones(8))) < 1e-12


def test_quadrature_weights():
    np.testing.assert_allclose(R.B, A[8] @ GAMMAS, rtol=0, atol=1e-13)
    assert abs(R.DRIFT - np.dot(R.B, R.D)) < 1e-15
    for k in range(5):  # of T**k, whose derivative at the start is 1 for k = 1 alone
        drift = R.DRIFT if k == 1 else 0.0
        assert abs(np.dot(R.B, NODES**k) + drift - 1 / (k + 1)) < 2e-14, k
    assert abs(np.dot(R.B, NODES**5) - 1 / 6) > 1e-4


# One step of the engine ---------------------------------------------------------------------------


@functools.cache
def step_of(law):
    """Return `rodas5p.step` under this law as machine code."""

    def step(y, w_lp, ramp, h, kappa, eta0, p):
        new, *others = R.step(point_at(law, p, y, kappa, eta0), w_lp, ramp, h)
        return (new.y, new.w, new.e), *others

    return Formula(step, (0.0,) * 3, *[0.0] * 5, (0.0,))


def step(y, w_lp, ramp, h, system):
    law, kappa, eta0, p = system
    return step_of(law)(tuple(y), w_lp, ramp, h, kappa, eta0, p)


@pytest.mark.parametrize("law", ["slip", "aging"])
@pytest.mark.parametrize("eta0", [0.02, 1.0, 50.0])
def test_one_step_equals_the_published_method(law, eta0):
    """The arrow solve and the scaled row are rearrangements, not approximations."""
    kappa, beta, w_lp, ramp, h = 0.7, 1.9, 1.3, 0.4, 0.11
    y = np.array([0.3, 0.2, -0.15])
    # Dc = V0 = sigma = 1 and mu0 = 0 make the twin's seconds and stresses dimensionless
    twin = Naive(a=1.0, b=beta, Dc=1.0, sigma=1.0, K=kappa, M=eta0, mu0=0.0, V0=1.0, law=law)

    def speed(t):
        return w_lp + ramp * t

    def f(t, y):
        return np.array(twin.rates(t, y, speed))

    f_t = np.array([kappa * ramp, 0, 0])
    y_new, error, dense = published_step(f, twin.jacobian(0, y, speed), f_t, y, h)
    (y_got, w_got, e_got), error_got, dense_got, _, _ = step(
        tuple(y), w_lp, ramp, h, (LAWS[law], kappa, eta0, (beta,))
    )
    np.testing.assert_allclose(y_got, y_new, rtol=0, atol=2e-14)
    np.testing.assert_allclose(w_got, np.exp(y_new[1]))
    np.testing.assert_allclose(e_got, [np.exp(-y_new[2])] if law == "aging" else [])
    np.testing.assert_allclose(error_got, error, rtol=0, atol=2e-14)
    s = 0.3  # of the step
    bends = dense[0] + s * (dense[1] + s * dense[2])
    inside = (1 - s) * y + s * (y_new + (1 - s) * bends)
    found = np.polynomial.polynomial.polyval(s, np.transpose(dense_got))
    np.testing.assert_allclose(found, inside, rtol=0, atol=2e-13)


def march_fixed(law, eta0, n, t_end=3.0):
    """Return x, v, psi and works at t_end; without inertia start at v = x - beta psi."""
    y, h, ramp = (0.5, -0.3 if eta0 else 0.18, 0.2), t_end / n, 0.25
    work = friction = 0.0
    for i in range(n):
        new, _, _, load_work, dissipation = step(
            y, 1.0 + ramp * i * h, ramp, h, (LAWS[law], 0.8, eta0, (1.6,))
        )
        y, work, friction = new[0], work + load_work, friction + dissipation
    return np.array([*y, work, friction])


@pytest.mark.parametrize("law", ["slip", "aging"])
@pytest.mark.parametrize(("eta0", "n"), [(0.0, 40), (0.5, 100), (5.0, 20)])
def test_observed_order(law, eta0, n):
    """Of the state, and of the works that ride along; the load point accelerates."""
    exact = march_fixed(law, eta0, 2560)
    errors = np.array([np.abs(march_fixed(law, eta0, m) - exact) for m in (n, 2 * n)])
    state = np.log2(errors[0, :3].max() / errors[1, :3].max())
    works = np.log2(errors[0, 3:].max() / errors[1, 3:].max())
    assert 4.8 < state < 5.2
    assert 4.8 < works < 5.2


# Orders seen by a user ----------------------------------------------------------------------------


def final(slider, t_end, **settings):
    run = rs.simulate(
        slider, rs.Loading.constant(2e-3), t_end, V_start=1e-3, times=[t_end], **settings
    )
    return np.array([run.tau[0] / 6e3, np.log(run.V[0]), np.log(run.theta[0])])


@pytest.mark.parametrize("law", ["slip", "aging"])
def test_error_follows_the_tolerance(law):
    """Error per unit time of an adaptive fifth-order method: about rtol**(5/5), and it is met."""
    slider = rs.SpringSlider(**FIG2, law=law)
    exact = final(slider, 0.1, rtol=1e-13)
    rtols = np.array([1e-4, 1e-6, 1e-8, 1e-10])
    found = [final(slider, 0.1, rtol=r, method="rodas5p") for r in rtols]
    errors = np.array([np.abs(one - exact).max() for one in found])
    assert (errors < 20 * rtols).all(), errors
    assert (errors > 1e-4 * rtols).all(), errors  # the test is not blind
    run = functools.partial(rs.simulate, slider, rs.Loading.constant(2e-3), 0.1, V_start=1e-3)
    steps = [int(run(rtol=r, method="rodas5p").steps) for r in (1e-7, 1e-12)]
    assert 0.8 * 10 < steps[1] / steps[0] < 1.25 * 10  # h ~ rtol**(1/5)
