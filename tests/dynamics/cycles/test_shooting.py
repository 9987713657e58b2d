"""The return map: section, multipliers, Newton's step; the attractors of orbits; their measures."""

import numpy as np
import pytest
from dimensionless import P1, P4B, make_system, measured_by_scipy

from ratestate.dynamics.cycles.attractor import find_attractors, steady_start
from ratestate.dynamics.cycles.measure import measure
from ratestate.dynamics.cycles.shooting import Returns, multipliers, return_map
from ratestate.dynamics.cycles.system import state

LAWS = pytest.mark.parametrize("law", ["slip", "aging"])


def returns_with(jacobians, trace, image=None):
    n = len(jacobians)
    image = np.zeros((n, 2)) if image is None else image
    return Returns(np.zeros(n), image, jacobians, {"trace": trace}, {})


# Algebra ------------------------------------------------------------------------------------------


# Attractors of orbits -----------------------------------------------------------------------------


@LAWS
def test_a_return_is_as_fine_as_its_cycle_attracts(law):
    """Errors of a return add up, along a slow direction, to 1/(1 - multiplier) times as much."""
    system = make_system(law, [0.2, 0.6, 1.05], 2.0, 0.5)
    attractors = find_attractors(system, steady_start(system), 1e-8, None)
    first = multipliers(return_map(system, state(system, attractors.u), 1e-10))[:, 0].real
    assert 0.0 < first.min() < 0.2 < first.max() < 0.8
    np.testing.assert_allclose(attractors.tol, 1e-8 * (1.0 - first), rtol=0.01)


# Measures of cycles -------------------------------------------------------------------------------


TOLERANCES = {
    "v_max": {"abs": 1e-6},
    "v_min": {"abs": 1e-6},
    "amplitude": {"rel": 1e-7},
    "g_max": {"rel": 1e-5},
    "slow_fraction": {"abs": 1e-7},
    "fundamental": {"rel": 5e-5},  # stress drops within a sample
}


@pytest.mark.parametrize(
    ("law", "parameters", "method"),
    [
        ("slip", P1, "DOP853"),
        ("aging", P4B, "Radau"),
    ],
)
def test_measures_against_a_dense_run(law, parameters, method):
    """Extremes, time spent sticking and the fundamental's share, by SciPy and a fast transform."""
    system = make_system(law, *parameters)
    attractors = find_attractors(system, steady_start(system), 1e-9, None)
    found = {name: value[0] for name, value in measure(system, attractors).items()}
    y, period = state(system, attractors.u)[0], found["period"]
    exact, _ = measured_by_scipy(law, parameters, y, period, method=method)
    for name, tolerance in TOLERANCES.items():
        assert found[name] == pytest.approx(exact[name], **tolerance), name
    assert 0.4 < exact["fundamental"] < 1
    assert found["residual"] < 1e-6


@LAWS
def test_measures_take_the_step_that_is_left(law):
    """From a point a little off, amplitude and period are the cycle's to second order."""
    system = make_system(law, 0.9 * 0.8 * 1.5, 1.8, 0.5)
    attractors = find_attractors(system, steady_start(system), 1e-11, None)
    exact = measure(system, attractors)
    off = measure(system, attractors._replace(u=attractors.u * (1 + 1e-5)))
    for name in ("period", "amplitude"):
        assert off[name] == pytest.approx(exact[name], rel=1e-8)
    assert 1e-6 < off["error"][0] < 1e-3  # but it is not trusted further than the step is long
    assert exact["error"][0] < 1e-10
    assert 1e-7 < off["residual"][0] < 1e-4


@pytest.mark.parametrize("size", [0.0, 3e-320, 1e-309, 1e-100, 0.5])
@pytest.mark.parametrize("k", [2, 3])
def test_multipliers_that_underflow(size, k):
    """The smallest is their product over the others, and 0 where that has no digits."""
    jacobian = size * np.diag([1.0, *[0.5] * (k - 1)])[None]
    with np.errstate(divide="ignore"):
        trace = np.log(size**k * 0.5 ** (k - 1))
    found = multipliers(returns_with(jacobian, np.array([trace])))[0]
    assert np.isfinite(found).all()
    smallest = 0.5 * size if size**k > 0.0 else 0.0
    assert found[0] == pytest.approx(size, rel=1e-9, abs=1e-305)
    assert found[-1] == pytest.approx(smallest, rel=1e-9)
