"""Steady sliding: the paper's numbers, limits, and eigenvalues against 60-digit arithmetic."""

import itertools

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ratestate as rs
from ratestate import formulas as rsf
from ratestate import stability
from ratestate.friction.closed_forms import steady_modes

FIG_2 = {"a": 0.003, "b": 0.006, "Dc": 1e-5, "sigma": 2e6}


def without(parameters, *symbols):
    return {symbol: value for symbol, value in parameters.items() if symbol not in symbols}


def test_numbers_of_fig_2():
    assert rsf.K_c_qs(**FIG_2) == pytest.approx(600e6, rel=1e-15, abs=0)
    V_c = rsf.V_c(**FIG_2, K=900e6, M=3000)
    assert V_c == pytest.approx(np.sqrt(1e-5), rel=1e-15, abs=0)  # 3.162 mm/s
    assert rsf.K_c(V_c, **FIG_2, M=3000) == pytest.approx(900e6, rel=1e-14, abs=0)
    slider = rs.SpringSlider(**FIG_2, K=900e6, M=3000)
    assert [bool(stability(slider, V).stable) for V in (0.3e-3, 3.1e-3, 3.2e-3)] == [
        True,
        True,
        False,
    ]


@given(st.floats(-9, 1), st.floats(0, 6), st.floats(-3, -1), st.floats(0.3, 5))
def test_eq_5_with_the_slopes_of_this_law_is_eq_6(log_V, log_M, log_a, ratio):
    V, M, a = 10**log_V, 10**log_M, 10**log_a
    p = {"a": a, "b": ratio * a, "Dc": 1e-5, "sigma": 2e6}
    slope = p["sigma"] * rsf.friction_partials(V, rsf.theta_ss(V, Dc=1e-5), a=a, b=p["b"])[0]
    h = 1e-30  # complex step through the steady-state friction
    ss = p["sigma"] * rsf.mu_ss(V * (1 + 1j * h), a=a, b=p["b"], mu0=0.6, V0=1e-6).imag / (V * h)
    general = rsf.K_c_of_any_law(V, Dc=1e-5, M=M, dtau_ss_dV=ss, dtau_dV=slope)
    assert general == pytest.approx(rsf.K_c(V, **p, M=M), rel=1e-13, abs=0)


@pytest.mark.parametrize(
    ("changes", "V_c"),
    [
        ({"K": 599e6}, 0.0),  # unstable at any speed
        ({"K": 599e6, "M": 0.0}, 0.0),
        ({"K": 900e6, "M": 0.0}, np.inf),  # only inertia could destabilise it
        ({"b": 0.003}, np.inf),  # never unstable
        ({"b": 0.002, "M": 0.0}, np.inf),
        ({"b": -0.002}, np.inf),
        ({"K": np.inf}, np.inf),
        ({"K": np.inf, "M": 0.0, "b": 0.001}, np.inf),
    ],
)
def test_limits_of_V_c(changes, V_c):
    assert rsf.V_c(**{**FIG_2, "K": 900e6, "M": 3000.0, **changes}) == V_c


def test_f_n_and_omega_c_at_their_limits():
    assert rsf.f_n(K=1e9, M=0) == rsf.f_n(K=np.inf, M=1) == rsf.f_n(K=np.inf, M=0) == np.inf
    assert rsf.omega_c(1e-3, a=0.003, b=0.006, Dc=1e-5) == pytest.approx(100, rel=1e-15, abs=0)
    assert np.isnan(rsf.omega_c(1e-3, a=0.003, b=0.003, Dc=1e-5))
    assert np.isnan(rsf.omega_c(1e-3, a=0.003, b=0.001, Dc=1e-5))


def exact_modes(V, a, b, Dc, sigma, K, M):
    """Return eigenvalues [1/s] in 60 digits, and the rounding of K or K_c over K - K_c."""
    with mpmath.workdps(60):
        V, a, b, Dc, sigma, K, M = map(mpmath.mpf, (V, a, b, Dc, sigma, K, M))
        eta, kappa = M * V**2 / (sigma * a * Dc), K * Dc / (a * sigma)
        cubic = [eta, 1 + eta, 1 - b / a + kappa, kappa]
        ascending = cubic[eta == 0 :][::-1]
        roots = mpmath.polyroots(ascending, maxsteps=2000, extraprec=1200, asc=True)
        terms = kappa, (b / a - 1) * (1 + eta)
        margin = abs(terms[0] - terms[1])
        amplification = float((terms[0] + abs(terms[1])) / margin) if margin else np.inf
        return [root * V / Dc for root in roots], amplification


physical = {
    "a": st.floats(-3, -1.3).map(lambda x: 10**x),
    "b": st.floats(0.3, 5),  # of a
    "Dc": st.floats(-7, -2).map(lambda x: 10**x),
    "sigma": st.floats(4, 9).map(lambda x: 10**x),
    "M": st.one_of(st.just(0.0), st.floats(-6, 6).map(lambda x: 10**x)),
    "K": st.floats(-2, 2.7).map(lambda x: 10**x),  # kappa
    "V": st.floats(-12, 1).map(lambda x: 10**x),
}


@settings(max_examples=150, deadline=None)
@given(st.fixed_dictionaries(physical))
def test_eigenvalues_over_the_physical_range(p):
    b, K = p["b"] * p["a"], p["K"] * p["a"] * p["sigma"] / p["Dc"]
    p = {**p, "b": b, "K": K}
    modes = rsf.eigenvalues(**p)
    exact, amplification = exact_modes(**p)
    assert modes.shape == (3,)
    assert (np.diff(modes.real) <= 0).all()
    if p["M"] == 0:
        assert modes[2] == -np.inf
    pairs = itertools.combinations(exact, 2)
    gap = min(abs(x - y) / max(abs(x), abs(y)) for x, y in pairs)  # 0 for a double root
    for root in exact:
        error = min(abs(complex(mode) - root) for mode in modes if np.isfinite(mode)) / abs(root)
        assert error < 1e-14 / max(gap, 1e-7)
    if (
        gap > 1e-3 and amplification < 1e12
    ):  # the growth rate is accurate too: only K - K_c may cancel
        growth = max(mpmath.re(root) for root in exact)
        assert abs(modes[0].real / growth - 1) < 1e-14 / gap * amplification


def test_eigenvalues_do_not_depend_on_neighbours():
    """They are equal to the bit, so a sweep does not depend on the size of its chunks."""
    random = np.random.default_rng(7)
    eta, kappa = 10 ** random.uniform(-12, 8, 500), 10 ** random.uniform(-4, 4, 500)
    beta = random.uniform(0, 40, 500)
    numbers = eta, kappa, beta, kappa - (beta - 1) * (1 + eta)
    together = steady_modes(*numbers)
    alone = np.array([steady_modes(*each) for each in zip(*numbers, strict=True)])
    assert (alone == together).all()


def test_eigenvalues_that_coincide_or_are_evenly_spaced():
    for roots, tolerance in (([-1, -2, -3], 1e-14), ([-1, -1, -1], 1e-4), ([-1, -4, -4], 1e-7)):
        _, c2, c1, c0 = np.poly(roots)
        eta = 1 / (c2 - 1)  # b = 0 whenever one root is -1: the state relaxes by itself
        kappa, beta = c0 * eta, 1 + (c0 - c1) * eta
        assert abs(beta) < 1e-14
        modes = steady_modes(*map(np.asarray, (eta, kappa, beta, kappa - (beta - 1) * (1 + eta))))
        np.testing.assert_allclose(modes, sorted(roots, reverse=True), rtol=tolerance)


@pytest.mark.parametrize("M", [0.0, 1e-3, 3000.0, 1e9])
def test_hopf_bifurcation(M):
    """At K = K_c the pair is +- i omega_c, whatever the mass, and stability turns there."""
    V = 3e-3
    critical = rsf.K_c(V, **FIG_2, M=M)
    omega_c = rsf.omega_c(V, **without(FIG_2, "sigma"))
    modes = rsf.eigenvalues(V, **FIG_2, K=critical, M=M)
    assert modes[0].imag == pytest.approx(omega_c, rel=1e-13, abs=0)
    assert modes[1] == modes[0].conjugate()
    assert abs(modes[0].real) < 1e-14 * omega_c
    for side in (-1, 1):  # one unit in the last place of K is enough
        slider = rs.SpringSlider(**FIG_2, K=np.nextafter(critical, side * np.inf), M=M)
        result = stability(slider, V)
        assert bool(result.stable) == (side > 0)
        assert np.sign(result.growth_rate) == -side


def test_rigid_limit():
    modes = rsf.eigenvalues(1e-3, **FIG_2, K=np.inf, M=np.array([0.0, 100.0]))
    np.testing.assert_array_equal(modes, np.tile([-100, -np.inf, -np.inf], (2, 1)))
    # this is the limit of stiff springs
    assert rsf.eigenvalues(1e-3, **FIG_2, K=1e22, M=0.0)[0] == pytest.approx(-100, rel=1e-12, abs=0)
    result = stability(rs.SpringSlider(**FIG_2, K=np.inf), 1e-3)
    assert bool(result.stable)
    assert (float(result.growth_rate), float(result.omega)) == (-100, 0)
