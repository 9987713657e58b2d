"""Taylor coefficients in time of expressions, compared with mpmath."""

import math

import mpmath as mp
import numpy as np
import pytest
from exact_functions import exact_function

from ratestate.friction.expressions import Graph
from ratestate.friction.functions import DERIVATIVES
from ratestate.friction.taylor import NoSeries, expand
from ratestate.laws import exp, where

ORDER = 8


@pytest.mark.parametrize("name", sorted(DERIVATIVES.keys() - {"abs"}))
def test_functions_of_a_series(name):
    """The argument is x = 0.7 + 0.4 t."""
    graph = Graph(merges=False)
    x = graph.symbol("x", is_constant=False)
    y = graph.call(name, x)
    (_, (found,)) = expand({x: graph.number(0.4)}, [y], ORDER, {x: 0.7})
    exact = exact_function(name)
    expected = mp.taylor(lambda t: exact(0.7 + 0.4 * t), 0, ORDER - 1)
    np.testing.assert_allclose(np.array(found, float), np.array(expected, float), rtol=1e-11)


@pytest.mark.parametrize("exponent", [2.0, 3.0, -1.0, -2.0, 0.5, -1.7])
def test_powers_of_a_series(exponent):
    graph = Graph(merges=False)
    x, a = graph.symbol("x", is_constant=False), graph.symbol("a")
    y = a * x**exponent * x / (1.0 + x)
    (_, (found,)) = expand({x: graph.number(0.4)}, [y], ORDER, {x: 0.7, a: 3.0})

    def exact(t):
        z = 0.7 + 0.4 * t
        return 3 * z ** (exponent + 1) / (1 + z)

    expected = mp.taylor(exact, 0, ORDER - 1)
    np.testing.assert_allclose(np.array(found, float), np.array(expected, float), rtol=1e-11)


def test_two_unknowns():
    """A pendulum-like pair: x' = y, y' = a - x exp(x), driven along a line a = 0.3 + 0.5 t."""
    graph = Graph(merges=False)
    x, y, a = (graph.symbol(name, is_constant=False) for name in "xya")
    rates = {x: y, y: a - x * exp(x)}
    (of_x, of_y), (work,) = expand(rates, [x * y], 20, {x: 0.2, y: 0.1, a: (0.3, 0.5)})
    solution = mp.odefun(
        lambda t, z: [z[1], 0.3 + 0.5 * t - z[0] * mp.exp(z[0])], 0, [mp.mpf(0.2), mp.mpf(0.1)]
    )
    t = 0.2
    found = [math.fsum(c * t**k for k, c in enumerate(one)) for one in (of_x, of_y)]
    np.testing.assert_allclose(found, np.array(solution(t), float), rtol=1e-14)
    assert work[0] == pytest.approx(0.02)
    assert len(work) == 20


def test_where_has_no_series():
    graph = Graph(merges=False)
    x = graph.symbol("x", is_constant=False)
    with pytest.raises(NoSeries):
        expand({x: where(x > 1.0, x, 1.0)}, [], 3, {x: 0.5})
