"""The equations derived from a law's formula, compared with mpmath."""

import itertools
import math

import mpmath as mp
import numpy as np
import pytest
from exact_functions import exact_function

from ratestate.friction.composition import composed, forms_of
from ratestate.friction.expressions import Graph
from ratestate.friction.functions import DERIVATIVES
from ratestate.friction.laws import LAWS
from ratestate.friction.rewriting import Derivative, Hoisting, values_of
from ratestate.laws import asinh, cosh, exp, log, maximum, sinh, sqrt, tanh, where

#: laws with psi as variable: "nagata" has another
NAMES = [name for name in LAWS if name != "nagata"]
PAIRS = [(name, form) for name in NAMES for form in forms_of(LAWS[name])]
EVERY = pytest.mark.parametrize(("name", "form"), PAIRS)


def random_parameters(rng):
    """Return parameters [SI] for any law and form, and V_ref."""
    log_uniform = {"a": (-3, -1), "Dc": (-7, -3), "V0": (-9, -3), "V_ref": (-9, -1)}
    q = {symbol: 10.0 ** rng.uniform(*ends) for symbol, ends in log_uniform.items()}
    q |= {"b": q["a"] * rng.uniform(0.3, 3.0), "b2": q["a"] * rng.uniform(-1.0, 1.0)}
    q |= {"mu0": rng.uniform(0.3, 0.8), "Dc2": q["Dc"] * 10.0 ** rng.uniform(-2, 2), "mu_w": 0.1}
    q |= {symbol: q["V0"] * 10.0 ** rng.uniform(0, 3) for symbol in ("V1", "V2", "V_cut", "V_w")}
    return q


def derivative_orders(n):
    """Return the variables, of n, of each derivative up to the third."""
    return [
        by for order in range(4) for by in itertools.combinations_with_replacement(range(n), order)
    ]


def derivative(equations, x, *by):
    """Return the derivative of an expression by each of these symbols in turn."""
    for symbol in by:
        x = Derivative(equations.graph, {symbol: equations.graph.one})(x)
    return x


@EVERY
def test_derivatives_at_extreme_speeds(name, form):
    """Each derivative is a difference of the previous one; its value in doubles is accurate.

    test_every_law.py compares the formulas with their sources.
    """
    rng = np.random.default_rng([*f"{name} {form}".encode()])
    equations, q = composed(LAWS[name], form).equations, random_parameters(rng)
    # flash heating has no steady sliding with negative friction
    low = -12 if name == "flash-heating" else -300
    n = len(equations.psi)
    ages = [10.0 ** rng.uniform(-300, 2) / q[D] for D in LAWS[name].lengths]
    y = [math.log(10) * rng.uniform(low, 2) - math.log(q["V_ref"])]
    y += [math.log(age) + math.log(q["V_ref"]) for age in ages]
    p = equations.coefficients(q["V_ref"], {k: np.float64(x) for k, x in q.items()})
    step = mp.mpf(10) ** -650
    with mp.workdps(1300):  # for differences of terms that may differ by a factor 1e600
        numbers = {symbol: mp.mpf(x) for symbol, x in q.items()}
        at = [mp.mpf(x) for x in y]
        symbols = {one: numbers.get(name) for name, one in equations._parameters.items()}
        values = values_of(equations.constants.values(), symbols)
        exact_p = dict(zip(equations.constants, values, strict=True))

        def value_of(expression, *y):
            known = exact_p | dict(zip([equations.v, *equations.psi], y, strict=True))
            return values_of([expression], known)[0]

        for root in (*equations.rates, *equations.resistance):
            for by in derivative_orders(1 + n):
                symbols = [(equations.v, *equations.psi)[i] for i in by]
                expression = derivative(equations, root, *symbols)
                true = value_of(expression, *at)
                (value,) = equations.values([expression], y[0], y[1:], p)
                assert abs(value - true) <= 1e-12 * abs(true) + 1e-300, by
                if by:
                    before = derivative(equations, root, *symbols[:-1])
                    moved = [x + step * (i == by[-1]) for i, x in enumerate(at)]
                    slope = (value_of(before, *moved) - value_of(before, *at)) / step
                    assert mp.almosteq(slope, true, 1e-20, 1e-300), by


# Expressions


POSITIVE_ARGUMENTS = {"log", "log1p"}


@pytest.mark.parametrize("name", sorted(DERIVATIVES))
@pytest.mark.parametrize("size", [1e-30, 1e-9, 0.3, 2.0, 30.0, 300.0])
def test_each_function_has_exact_derivatives(name, size):
    graph = Graph(merges=False)
    x = graph.symbol("x", is_constant=False)
    by_x = Derivative(graph, {x: graph.number(1.0)})
    exact = exact_function(name)
    for at in (size,) if name in POSITIVE_ARGUMENTS else (size, -size):
        y = graph.call(name, x)
        for order in range(4):
            value = values_of([y], {x: at})[0]
            with mp.workdps(800):
                true = mp.diff(exact, mp.mpf(at), order) if order else exact(mp.mpf(at))
                if name == "abs" and order > 1:
                    true = 0
            # if a derivative is a small difference, its rounding error is relative to the terms
            floor = 1e-15 * abs(true) + 1e-300 if order < 2 else 1e-14
            assert abs(value - true) <= max(1e-12 * abs(true), floor if order > 1 else 0.0), order
            y = by_x(y)


def test_a_positive_quantity_carries_its_logarithm():
    graph = Graph()
    V0 = graph.symbol("V0", is_positive=True)
    x, y = (graph.symbol(name, is_constant=False) for name in "xy")
    V = V0 * exp(x)
    assert log(V * exp(y) / V0) is x + y
    assert log(V**2.5) - log(V0**2.5) is 2.5 * x
    assert exp(log(V) + y) is V * exp(y)
    assert log(1.0 + V / V0).kind == "softplus"
    assert values_of([1.0 / (1.0 + exp(x))], {x: 800.0})[0] == 0.0
    assert values_of([1.0 - exp(x)], {x: 1e-20})[0] == -1e-20
    assert log(sqrt(V)).terms[x] == 0.5


#: formulas of u = e**x and n = 3, as a user may write them; x; the exact value
FORMULAS = [
    (lambda u, n: (1.0 - u) ** 20, 1.0, lambda u: (1 - u) ** 20),
    (lambda u, n: 1.0 / (n * (1.0 + u**8)), 23.0, lambda u: 1 / (3 * (1 + u**8))),
    (lambda u, n: log(u + 1.0), -46.0, lambda u: mp.log(1 + u)),
    (
        lambda u, n: (u / 1e-6) ** 60 * (n * u) ** -40,
        -60.0,
        lambda u: mp.mpf(10) ** 360 * u**20 / mp.mpf(3) ** 40,
    ),
    (lambda u, n: maximum(1.0 - u, 0.0) ** n, 0.5, lambda u: mp.mpf(0) * u),
    (lambda u, n: maximum(1.0 - u, 0.0) ** 1.5, -0.5, lambda u: (1 - u) ** 1.5),
    (lambda u, n: ((1.0 - u) ** 2) ** 2.5, 0.1, lambda u: abs(1 - u) ** 5),
    (lambda u, n: log(sinh(log(u)) ** 2), -1.0, lambda u: mp.log(mp.sinh(mp.log(u)) ** 2)),
    (lambda u, n: u * where(u > 2.0, 1.0, 0.0) + abs(log(u)), -1.0, lambda u: -mp.log(u)),
    (lambda u, n: 1.0 / cosh(u), 6.7, lambda u: 1 / mp.cosh(u)),
    (lambda u, n: tanh(u) / u - asinh(u), 0.3, lambda u: mp.tanh(u) / u - mp.asinh(u)),
    (lambda u, n: n**u + sqrt(u) * np.int64(2), 0.3, lambda u: 3**u + 2 * mp.sqrt(u)),
]


@pytest.mark.parametrize(("formula", "x", "truth"), FORMULAS)
def test_formulas_as_a_user_may_write_them(formula, x, truth):
    graph, hoisting = Graph(), Hoisting()
    symbol, n = graph.symbol("x", is_constant=False), graph.symbol("n", is_positive=True)
    y = hoisting(formula(exp(symbol), n))
    at, one = hoisting(symbol), hoisting.graph.number(1.0)
    constants = values_of(hoisting.constants.values(), {n: 3.0})
    known = dict(zip(hoisting.constants, constants, strict=True))
    for order in range(3):
        (value,) = values_of([y], known | {at: x})
        with mp.workdps(400):
            true = mp.diff(lambda t: truth(mp.exp(t)), mp.mpf(x), order)
        assert value == pytest.approx(float(true), rel=1e-11, abs=1e-300)
        y = Derivative(hoisting.graph, {at: one})(y)


def test_where_ignores_the_side_that_is_not_selected():
    graph = Graph()
    x = graph.symbol("x", is_constant=False)
    y = where(x > 0.0, log(abs(x)) * exp(-1.0 / x), x * x)
    by_x = Derivative(graph, {x: graph.number(1.0)})
    found = values_of([y, by_x(y)], {x: np.array([-3.0, 0.0])})
    np.testing.assert_array_equal(found, [[9.0, 0.0], [-6.0, 0.0]])
