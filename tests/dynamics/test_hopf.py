"""The Hopf bifurcation against closed forms, eigenvalues, and a normal form in 60 digits."""

import itertools
import math

import mpmath
import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

import ratestate as rs
from ratestate import bautin, hopf, stability
from ratestate.friction.normal_form import law_curvatures, lyapunov_1
from ratestate.paper.figures import LAWS

FIG_2 = {"a": 0.003, "b": 0.006, "Dc": 1e-5, "sigma": 2e6}
mp = mpmath.MPContext()
mp.dps = 60


# The first Lyapunov coefficient of any system, and the systems on which it is tried.


def symmetric(form, count):
    """A form (index of equation, indices of variables -> number) as a function of vectors."""

    def of(*vectors):
        total = [mp.mpc(0)] * len(vectors[0])
        for (i, *where), value in form.items():
            ways = set(itertools.permutations(where))
            assert len(where) == count
            total[i] += value * sum(
                mp.fprod(u[k] for u, k in zip(vectors, way, strict=True)) for way in ways
            )
        return mp.matrix(total)

    return of


def first_lyapunov(A, second, third, measure):
    """l1 of dr/dt = growth r + l1 r^3 for ``measure . x = r cos(omega t)``, by Kuznetsov's formula.

    A : Jacobian with one pair of eigenvalues +- i omega
    second, third : {(i, j, k): d2 f_i/dx_j dx_k}, {(i, j, k, l): ...}, j <= k <= l
    """
    A = mp.matrix(A)
    n = A.rows
    B, C = symmetric(second, 2), symmetric(third, 3)
    values, left, right = mp.eig(A, left=True, right=True)
    pair = min(range(n), key=lambda i: abs(mp.re(values[i])) if mp.im(values[i]) > 0 else mp.inf)
    omega = mp.im(values[pair])
    q, p = right[:, pair], left[pair, :]
    q = q / mp.fdot(measure, q)
    p = p / (p * q)[0]
    conjugate = q.apply(mp.conj)
    cubic = (
        C(q, q, conjugate)
        - 2 * B(q, mp.lu_solve(A, B(q, conjugate)))
        + B(conjugate, mp.lu_solve(2j * omega * mp.eye(n) - A, B(q, q)))
    )
    return mp.re((p * cubic)[0]) / 8


# The slider through the same formula.


def slider_system(eta, b1, state_1, state_2, state_3):
    """The dimensionless slider at its Hopf bifurcation; state_n: n-th derivatives of d psi/dT.

    dx/dT = kappa (1 - e^v), dv/dT = (x - v - beta psi) e^-v/eta.
    """
    eta, b1 = mp.mpf(eta), mp.mpf(b1)
    kappa, beta = b1 * (1 + eta), 1 + b1
    A = [[0, -kappa, 0], [1 / eta, -1 / eta, -beta / eta], [0, *state_1]]
    second = {(0, 1, 1): -kappa, (1, 0, 1): -1 / eta, (1, 1, 1): 2 / eta, (1, 1, 2): beta / eta}
    second |= dict(zip([(2, 1, 1), (2, 1, 2), (2, 2, 2)], state_2, strict=True))
    third = {(0, 1, 1, 1): -kappa, (1, 0, 1, 1): 1 / eta}
    third |= {(1, 1, 1, 1): -3 / eta, (1, 1, 1, 2): -beta / eta}
    indices = [(2, 1, 1, 1), (2, 1, 1, 2), (2, 1, 2, 2), (2, 2, 2, 2)]
    return A, second, third | dict(zip(indices, state_3, strict=True)), [0, 1, 0]


#: first, second and third derivatives of d psi/dT in steady sliding: by v alone, then more by psi
RATES = {
    "slip": ((-1, -1), (-2, -1, 0), (-3, -1, 0, 0)),  # of -exp(v) (v + psi)
    "aging": ((-1, -1), (-1, 0, 1), (-1, 0, 0, -1)),  # of exp(-psi) - exp(v)
}


def exact(law, eta, b1):
    """l1 [V/Dc] in 60 digits."""
    return first_lyapunov(*slider_system(eta, b1, *RATES[law]))


@pytest.mark.parametrize("law", LAWS)
@settings(max_examples=60, deadline=None)
@given(log_eta=st.floats(-14, 14), log_b1=st.floats(-6, 2))
def test_lyapunov_1_over_the_physical_range(law, log_eta, log_b1):
    eta, b1 = 10**log_eta, 10**log_b1
    value, doubt = lyapunov_1(eta, b1, *law_curvatures(law))
    truth = exact(law, eta, b1)
    assert abs(value - truth) < 0.2 * doubt  # the rest is for eta and b1
    if law == "slip" or abs(eta * (3 + 2 * math.sqrt(4 + b1)) - 1) > 0.01:
        assert float(value / truth) == pytest.approx(1, rel=1e-11, abs=0)
        assert doubt < 1e-11 * abs(value)


@pytest.mark.parametrize(("eta", "b1"), [(1e-3, 3.0), (0.3, 0.1), (20.0, 3.0)])
@pytest.mark.parametrize(("h2", "h3"), [(0.3, 0.0), (0.0, 0.7), (-1.2, 2.0)])
def test_lyapunov_1_of_any_law_with_one_length(eta, b1, h2, h3):
    """d psi/dT = w h(v + psi), h = -z + h2 z^2/2 + h3 z^3/6; without inertia not degenerate."""
    second = h2 - 2, h2 - 1, h2
    third = h3 + 3 * h2 - 3, h3 + 2 * h2 - 1, h3 + h2, h3
    truth = first_lyapunov(*slider_system(eta, b1, (-1, -1), second, third))
    value, _ = lyapunov_1(eta, b1, h2, h3)
    assert value == pytest.approx(float(truth), rel=1e-13, abs=0)


# The functions.

physical = {
    "a": st.floats(-3, -1.3).map(lambda x: 10**x),
    "Dc": st.floats(-7, -2).map(lambda x: 10**x),
    "sigma": st.floats(4, 9).map(lambda x: 10**x),
    "M": st.floats(-6, 6).map(lambda x: 10**x),
}


@settings(max_examples=60, deadline=None)
@given(
    st.fixed_dictionaries(physical),
    st.floats(1.001, 50),
    st.floats(-2, 2).map(lambda x: 10**x),
    st.sampled_from(sorted(LAWS)),
)
def test_point_is_where_the_eigenvalues_say(p, ratio, excess, law):
    p["b"] = ratio * p["a"]
    K_c_qs = (p["b"] - p["a"]) * p["sigma"] / p["Dc"]
    K = (1 + excess) * K_c_qs
    slider = rs.SpringSlider(**p, K=K, law=law)
    point = hopf(slider)
    V = math.sqrt(p["sigma"] * p["a"] * p["Dc"] / p["M"] * excess)
    assert float(point.V_c) == pytest.approx(V, rel=1e-10, abs=0)
    assert float(point.K_c) == K
    assert float(point.eta) == pytest.approx(excess, rel=1e-10, abs=0)
    omega = V / p["Dc"] * math.sqrt(ratio - 1)
    assert float(point.omega_c) == pytest.approx(omega, rel=1e-10, abs=0)
    assert float(point.frequency) == pytest.approx(omega / 2 / math.pi, rel=1e-10, abs=0)
    modes = stability(slider, float(point.V_c)).eigenvalues.values
    assert modes[0].imag == pytest.approx(float(point.omega_c), rel=1e-10, abs=0)
    assert modes[2] == pytest.approx(float(point.eigenvalue_3), rel=1e-10, abs=0)
    assert abs(modes[0].real) < 1e-10 * omega
    # the other way round
    back = hopf(slider.replace(K=1.0), float(point.V_c))
    assert float(back.K_c) == pytest.approx(K, rel=1e-12, abs=0)
    for name in ("V_c", "eta", "omega_c", "frequency", "eigenvalue_3", "lyapunov_1"):
        near = 1e-10 if name != "lyapunov_1" or law == "slip" else 1e-8
        if near == 1e-10 or abs(excess / bautin(law, ratio) - 1) > 1e-3:
            assert float(back[name]) == pytest.approx(float(point[name]), rel=near, abs=0)
    # |dr/dt|: both parameters move the same growth rate, 2 eta/(1 + eta) as fast by V as by K
    share = float(point.amplitude_coefficient / back.amplitude_coefficient) ** 2
    assert share == pytest.approx(2 * excess / (1 + excess), rel=1e-6, abs=0)


@pytest.mark.parametrize("ratio", [1 + 1e-9, 1.001, 1.5, 2.0, 10.0, 1e3])
def test_bautin_point_of_the_aging_law(ratio):
    eta = bautin("aging", ratio)
    assert isinstance(eta, float)
    assert eta == pytest.approx(1 / (3 + 2 * math.sqrt(ratio + 3)), rel=1e-13, abs=0)
    for side in (-1, 1):
        near = eta * (1 + side * 1e-9)
        assert mp.sign(exact("aging", near, ratio - 1)) == -side
        K = (ratio - 1) * 0.003 * 2e6 / 1e-5 * (1 + near)
        slider = rs.SpringSlider(a=0.003, b=0.003 * ratio, Dc=1e-5, sigma=2e6, K=K, M=30.0)
        V = math.sqrt(near * 2e6 * 0.003 * 1e-5 / 30.0)
        for law, kind in (("aging", ["super", "sub"][side < 0]), ("slip", "super")):
            assert str(hopf(slider.replace(law=law), V).type.values) == kind + "critical"
    V = math.sqrt(eta * 2e6 * 0.003 * 1e-5 / 30.0)
    point = hopf(slider.replace(law="aging"), V)
    assert str(point.type.values) == "degenerate"
    assert float(point.amplitude_coefficient) == np.inf


@pytest.mark.parametrize("law", LAWS)
@settings(deadline=None)
@given(log_b1=st.floats(-6, 3))
def test_type_changes_nowhere_else(law, log_b1):
    b1 = 10**log_b1
    eta = np.logspace(-16, 16, 321)
    value, _ = lyapunov_1(eta, b1, *law_curvatures(law))
    change = bautin(law, 1 + b1)
    np.testing.assert_array_equal(value > 0, eta < change if law == "aging" else eta < 0)
    assert np.isnan(change) == (law == "slip")


def test_bautin_over_arrays():
    ratio = rs.logspace("b_over_a", 1.1, 100, 5)
    curve = bautin("aging", ratio)
    assert curve.dims == ("b_over_a",)
    assert (curve.name, curve.attrs["units"]) == ("eta", "1")
    assert curve.values.tolist() == [bautin("aging", float(x)) for x in ratio]
    assert np.isnan(bautin("slip", ratio)).all()


NONE = {
    "unstable at any speed": ({"K": 599e6}, 0.0),
    "at K_c_qs": ({"a": 0.5, "b": 1.0, "Dc": 1.0, "sigma": 2.0, "K": 1.0}, 0.0),
    "unstable without mass": ({"K": 599e6, "M": 0.0}, 0.0),
    "stable without mass": ({"M": 0.0}, np.inf),
    "neutral": ({"b": 0.003}, np.inf),
    "strengthening": ({"b": 0.001}, np.inf),
    "b < 0": ({"b": -0.001, "M": 0.0}, np.inf),
    "rigid": ({"K": np.inf}, np.inf),
    "rigid without mass": ({"K": np.inf, "M": 0.0}, np.inf),
}


@pytest.mark.parametrize(("changes", "V_c"), NONE.values(), ids=NONE)
@pytest.mark.parametrize("law", LAWS)
def test_no_bifurcation_in_V(law, changes, V_c):
    point = hopf(rs.SpringSlider(**{**FIG_2, "K": 9e8, "M": 3e3, **changes}, law=law))
    assert str(point.type.values) == "none"
    assert float(point.V_c) == V_c
    rest = point.drop_vars(["type", "V_c"])
    assert all(np.isnan(rest[name]) for name in rest)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("K", [1e8, 9e8, np.inf])
def test_without_mass_the_bifurcation_in_K_is_degenerate(law, K):
    point = hopf(rs.SpringSlider(**FIG_2, K=K, law=law), "1 mm/s")
    assert str(point.type.values) == "degenerate"
    assert float(point.K_c) == pytest.approx(6e8, rel=1e-15)
    assert (float(point.eta), float(point.lyapunov_1)) == (0, 0)
    assert float(point.omega_c) == pytest.approx(100, rel=1e-15)
    assert float(point.eigenvalue_3) == -np.inf
    assert float(point.amplitude_coefficient) == np.inf


@pytest.mark.parametrize(
    ("law", "ratio", "message"),
    [
        ("nope", 2.0, "law = 'nope' is unknown"),
        ("nagata", 2.0, "law = 'nagata' cannot be used in bautin"),
        ("aging", 1.0, "b_over_a = 1 must be > 1.*without a Hopf bif"),
        ("slip", -2.0, "b_over_a = -2 must be > 1"),
        ("slip", xr.DataArray([2.0, 0.5], dims="q"), "b_over_a = 0.5 must be > 1"),
        ("slip", [2.0], "For many values"),
    ],
)
def test_bad_input_of_bautin(law, ratio, message):
    with pytest.raises(rs.ParameterError, match=message):
        bautin(law, ratio)
