"""Each friction law: its formulas, steady states, parameters, and pickle."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from textbook import OF_LAW, Textbook, drawn, drawn_of_form

import ratestate as rs
from ratestate.friction.composition import composed, forms_of
from ratestate.friction.law_formula import HASH_MARK
from ratestate.friction.laws import LAWS

NAMES = pytest.mark.parametrize("name", LAWS)


@pytest.mark.parametrize(
    ("name", "form"), [(name, form) for name, law in LAWS.items() for form in forms_of(law)]
)
@given(seed=st.integers(0, 10**6))
def test_friction_and_evolution_match_the_textbook(name, form, seed):
    """Reported states are functions of the variables, and back."""
    rng = np.random.default_rng(seed)
    parameters, V0 = drawn_of_form(name, rng, form)
    law, twin = composed(LAWS[name], form), Textbook(name, parameters)
    values = {k: np.array([x]) for k, x in parameters.items() if k != "friction_form"}
    p = tuple(float(x[0]) for x in law.coefficient_arrays(V0, values))
    v, theta = rng.normal(), [D / V0 * math.exp(rng.normal()) for D in twin.D]
    V, logs = (
        V0 * math.exp(v),
        tuple(math.log(V0 * th / D) for th, D in zip(theta, twin.D, strict=True)),
    )
    psi = law.variables(v, logs, p)
    np.testing.assert_allclose(law.log_states(v, psi, p), logs, rtol=1e-13, atol=1e-13)
    reference = law.reference_friction(np.array([V0]), values)[0]
    mu = reference + parameters["a"] * law.at_speed(v, psi, p).R
    assert mu == pytest.approx(twin.mu(V, theta), abs=1e-12)
    steady = twin.mu(V0, twin.steady_theta(V0))
    assert law.steady_friction(np.array([V0]), values)[0] == pytest.approx(steady, abs=1e-12)
    # d ln theta/dt at constant V, from the rates of the variables, on which ln theta is linear
    rates = law.at_speed(v, psi, p).f
    later = law.log_states(v, tuple(x + rate for x, rate in zip(psi, rates, strict=True)), p)
    by_us = [(x - y) * V0 / parameters["Dc"] for x, y in zip(later, logs, strict=True)]
    if name == "nagata":  # at constant V, mu changes through theta alone
        aging = 1.0 - V * theta[0] / parameters["Dc"]
        d_mu = parameters["b"] * aging / theta[0] / (1.0 + parameters["c"])
    else:
        d_mu = math.nan
    expected = twin.evolution(V, theta, d_mu)
    for ours, rate, th in zip(by_us, expected, theta, strict=True):
        assert ours == pytest.approx(rate / th, rel=1e-9, abs=1e-10 * V / parameters["Dc"])


@NAMES
def test_steady_sliding_is_steady(name):
    rng = np.random.default_rng(4)
    law = composed(LAWS[name])
    for _ in range(20):
        parameters, V = drawn(name, rng)
        values = {k: np.array([x]) for k, x in parameters.items()}
        p = law.coefficient_arrays(V, values)
        at = law.steady(p)
        rates, psi = at.f, at.psi
        rounding = 2e-14 if name == "flash-heating" else 4e-16  # its terms are mu/a
        np.testing.assert_allclose(rates, 0.0, atol=rounding)
        theta = [
            D / V * math.exp(x[0])
            for D, x in zip(Textbook(name, parameters).D, law.log_states(0.0, psi, p), strict=True)
        ]
        np.testing.assert_allclose(theta, Textbook(name, parameters).steady_theta(V), rtol=1e-13)


def test_the_textbook_has_each_built_in_law():
    assert set(OF_LAW) == {name for name in LAWS if HASH_MARK not in name}
    assert all(set(OF_LAW[name]) == set(LAWS[name].parameters) for name in OF_LAW)


def slider(law, **changes):
    common = {"a": 0.003, "b": 0.006, "Dc": 1e-5, "sigma": 2e6, "M": 3e3, "K": 9e8}
    return rs.SpringSlider(**(common | OF_LAW[law] | changes), law=law)


@NAMES
def test_a_slider_has_the_parameters_of_its_law(name):
    own = slider(name)
    assert {symbol: getattr(own, symbol) for symbol in OF_LAW[name]} == OF_LAW[name]
    assert rs.SpringSlider(**own.parameters) == own
    assert own.replace(law="slip") == slider("slip")
    assert eval(repr(own), {"SpringSlider": rs.SpringSlider}) == own
    for symbol, value in OF_LAW[name].items():
        assert getattr(own.replace(**{symbol: 2 * value}), symbol) == 2 * value
        missing = {k: x for k, x in own.parameters.items() if k != symbol}
        with pytest.raises(rs.ParameterError, match=rf"'{name}' needs {symbol}, "):
            rs.SpringSlider(**missing)
