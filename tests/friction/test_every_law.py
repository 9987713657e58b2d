"""Each friction law by itself: derivatives, steady states, closed forms, and how it is found."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from textbook import OF_LAW, Textbook, drawn

import ratestate as rs
from ratestate.friction.composition import composed
from ratestate.friction.law import FrictionLaw
from ratestate.friction.laws import LAWS
from ratestate.friction.user_law import MARK

NAMES = pytest.mark.parametrize("name", LAWS)
SMALL = 1e-30  # an imaginary part so small that its square is nothing
RATES = ("rates", "rate_partials", "rate_partials_2", "rate_partials_3")


def at_random(name, seed):
    """The law, a state (v, psi) and coefficients p."""
    law, rng = composed(LAWS[name]), np.random.default_rng(seed)
    parameters, V = drawn(name, rng)
    values = {symbol: np.array([x]) for symbol, x in parameters.items()}
    p = tuple(float(x[0]) for x in law.coefficient_arrays(V, values))
    return law, rng.normal(), tuple(rng.normal(size=len(law.states))), p


def call(law, method, v, psi, p):
    """A method of the law, whose exponentials are found here; as an array."""
    w = np.exp(v)
    if method in RATES:
        return np.array(getattr(law, method)(v, w, psi, law.exponentials(v, w, psi, p), p))
    return getattr(law, method)(v, w, psi, p)


def moved(psi, k):
    """psi, the k-th by an imaginary step."""
    return tuple(x + (1j * SMALL if j == k else 0.0) for j, x in enumerate(psi))


@NAMES
@given(seed=st.integers(0, 10**6))
def test_derivatives_of_rates_by_complex_steps(name, seed):
    law, v, psi, p = at_random(name, seed)
    for lower, upper in itertools.pairwise(RATES):
        found = call(law, upper, v, psi, p)
        size = 1e-12 * max(1.0, np.abs(found).max())
        by_v = np.imag(call(law, lower, v + 1j * SMALL, psi, p)) / SMALL
        np.testing.assert_allclose(np.atleast_2d(by_v), found[:-1], rtol=0, atol=size)
        for k in range(len(psi)):
            by_psi = np.atleast_2d(np.imag(call(law, lower, v, moved(psi, k), p)) / SMALL)
            np.testing.assert_allclose(by_psi[:, k], found[1:, k], rtol=0, atol=size)
            others = [j for j in range(len(psi)) if j != k]
            assert (by_psi[:, others] == 0).all()  # each state knows itself and v alone


@NAMES
@given(seed=st.integers(0, 10**6))
def test_derivatives_of_friction_by_complex_steps(name, seed):
    law, v, psi, p = at_random(name, seed)
    by_v, by_psi = call(law, "resistance_partials", v, psi, p)
    step = call(law, "resistance", v + 1j * SMALL, psi, p)
    assert by_v == pytest.approx(step.imag / SMALL, rel=1e-13)
    assert by_v > 0
    for k, slope in enumerate(by_psi):
        step = call(law, "resistance", v, moved(psi, k), p)
        assert slope == pytest.approx(step.imag / SMALL, rel=1e-13)
    by_vv, by_vpsi, by_psipsi = call(law, "resistance_partials_2", v, psi, p)
    # friction of eq. 1 is linear, and so is another so far from rest
    np.testing.assert_allclose((by_vv, *by_vpsi), 0.0, atol=1e-10)
    assert np.shape(by_psipsi) == (len(psi), len(psi))


@NAMES
@given(seed=st.integers(0, 10**6))
def test_friction_and_evolution_are_those_of_the_textbook(name, seed):
    """By the states as they are reported, which are functions of the variables and back."""
    rng = np.random.default_rng(seed)
    parameters, V0 = drawn(name, rng)
    law, twin = composed(LAWS[name]), Textbook(name, parameters)
    values = {k: np.array([x]) for k, x in parameters.items()}
    p = tuple(float(x[0]) for x in law.coefficient_arrays(V0, values))
    v, theta = rng.normal(), [D / V0 * math.exp(rng.normal()) for D in twin.D]
    V, logs = (
        V0 * math.exp(v),
        tuple(math.log(V0 * th / D) for th, D in zip(theta, twin.D, strict=True)),
    )
    psi = law.variables(v, logs, p)
    np.testing.assert_allclose(law.log_states(v, psi, p), logs, rtol=1e-13, atol=1e-13)
    reference = law.reference_friction(np.array([V0]), values)[0]
    mu = reference + parameters["a"] * law.resistance(v, math.exp(v), psi, p)
    assert mu == pytest.approx(twin.mu(V, theta), abs=1e-12)
    # d ln theta/dt at constant V, from the rates of the variables
    rates = call(law, "rates", v, psi, p)
    h = 1e-30
    later = law.log_states(v, tuple(x + 1j * h * r for x, r in zip(psi, rates, strict=True)), p)
    by_us = [x.imag / h * V0 / parameters["Dc"] for x in map(complex, later)]
    if name == "nagata":  # where V is constant mu changes by theta alone
        aging = 1.0 - V * theta[0] / parameters["Dc"]
        d_mu = parameters["b"] * aging / theta[0] / (1.0 + parameters["c"])
    else:
        d_mu = math.nan
    expected = twin.evolution(V, theta, d_mu)
    for ours, rate, th in zip(by_us, expected, theta, strict=True):
        assert ours == pytest.approx(rate / th, rel=1e-9, abs=1e-10 * V / parameters["Dc"])


@NAMES
def test_steady_sliding_is_steady(name):
    """Where the law knows it in closed form, too, and as the numbers that any law would get."""
    rng = np.random.default_rng(4)
    law = composed(LAWS[name])
    for _ in range(20):
        parameters, V = drawn(name, rng)
        values = {k: np.array([x]) for k, x in parameters.items()}
        p = law.coefficient_arrays(V, values)
        psi = law.steady_variables(p)
        rates = law.rates(0.0, 1.0, psi, law.exponentials(0.0, 1.0, psi, p), p)
        np.testing.assert_allclose(rates, 0.0, atol=4e-16)
        by_search = FrictionLaw.steady_variables(law, p)
        np.testing.assert_allclose(by_search, psi, rtol=1e-12, atol=1e-15)
        theta = [
            D / V * math.exp(x[0])
            for D, x in zip(Textbook(name, parameters).D, law.log_states(0.0, psi, p), strict=True)
        ]
        np.testing.assert_allclose(theta, Textbook(name, parameters).steady_theta(V), rtol=1e-13)


@pytest.mark.parametrize("name", [name for name, law in LAWS.items() if law.gives("held")])
def test_state_after_a_time_at_constant_speed(name):
    """The closed form against SciPy, its derivative by the speed against differences."""
    for seed in range(10):
        law, v, psi, p = at_random(name, seed)
        h = 10 ** np.random.default_rng(seed).uniform(-3, 1)

        def rates(_, psi, law=law, v=v, p=p):
            return call(law, "rates", v, tuple(psi), p)

        run = solve_ivp(rates, (0.0, h), psi, "Radau", rtol=1e-11, atol=1e-12)
        found, slope = law.held(psi, v, math.exp(v), h, p)
        np.testing.assert_allclose(found, run.y[:, -1], rtol=0, atol=1e-8)
        d = 1e-5
        up, down = (law.held(psi, v + s, math.exp(v + s), h, p)[0] for s in (d, -d))
        np.testing.assert_allclose(slope, np.subtract(up, down) / (2 * d), rtol=0, atol=1e-8)


def test_laws_are_the_files_of_their_folder_and_the_default_comes_first():
    built_in = [name for name in LAWS if MARK not in name]
    assert built_in == ["slip", *sorted(set(built_in) - {"slip"})]
    assert set(OF_LAW) == set(built_in)
    assert all(set(OF_LAW[name]) == set(LAWS[name].parameters) for name in built_in)


def slider(law, **changes):
    common = {"a": 0.003, "b": 0.006, "Dc": 1e-5, "sigma": 2e6, "M": 3e3, "K": 9e8}
    return rs.SpringSlider(**(common | OF_LAW[law] | changes), law=law)


@NAMES
def test_a_sliders_parameters_are_those_of_its_law(name):
    own = slider(name)
    assert {symbol: getattr(own, symbol) for symbol in OF_LAW[name]} == OF_LAW[name]
    assert rs.SpringSlider(**own.parameters) == own
    assert own.replace(law="slip") == slider("slip")
    assert eval(repr(own), {"SpringSlider": rs.SpringSlider}) == own
    for symbol, value in OF_LAW[name].items():
        assert getattr(own.replace(**{symbol: 2 * value}), symbol) == 2 * value
        missing = {k: x for k, x in own.parameters.items() if k != symbol}
        with pytest.raises(rs.ParameterError, match=rf"'{name}' needs {symbol}, .*expected a"):
            rs.SpringSlider(**missing)


@pytest.mark.parametrize(
    ("law", "changes", "said"),
    [
        (
            "slip",
            {"b2": 0.1},
            "law = 'slip' has no parameter b2, which belongs to 'two-state-aging'",
        ),
        ("aging", {"Dc3": 0.1}, "SpringSlider has no parameter Dc3; expected one of"),
        ("nagata", {"c": -0.1}, "c = -0.1 must be >= 0"),
        ("nagata", {"b": 0.0}, "law = 'nagata': b = 0 where c > 0; give another b, or c = 0"),
        ("kato-tullis", {"V_cut": 0.0}, "V_cut = 0 m/s must be > 0"),
        ("kato-tullis", {"V_cut": "3 um"}, "is a length"),
        ("two-state-slip", {"Dc2": "1 s"}, "is a time"),
        ("two-state-slip", {"b2": np.nan}, "b2 = nan is not a number"),
    ],
)
def test_parameters_that_a_law_refuses(law, changes, said):
    with pytest.raises(rs.ParameterError) as error:
        slider(law, **changes)
    assert said in str(error.value)


def test_steady_states_of_many_sliders_are_found_where_no_law_knows_them():
    """Some converge sooner than others: exp(-psi) r = 1, so that psi = ln r."""

    class Healing(FrictionLaw):
        def coefficients(self, V_ref, slider):
            return slider.b / slider.a, slider.r

        def rates(self, v, w, psi, e, p):
            return (p[1] * np.exp(-psi[0]) - w,)

        def rate_partials(self, v, w, psi, e, p):
            return (-w,), (-p[1] * np.exp(-psi[0]),)

    r = np.array([0.5, 1.0, 2.0, 3.0, 900.0, 1e-8])
    (psi,) = Healing().steady_variables((np.full(6, 1.2), r))
    np.testing.assert_allclose(psi, np.log(r), atol=1e-12)
    (one,) = Healing().steady_variables((1.2, np.array(2.0)))
    assert one == pytest.approx(np.log(2.0), rel=1e-12)
