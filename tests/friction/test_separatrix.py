"""Runaway without inertia: its edge, and status only beyond the edge."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import ratestate as rs
from ratestate.dynamics.basin import escape
from ratestate.engine.model import STEADY_SLIDING
from ratestate.friction.laws import LAWS
from ratestate.friction.quasi_static import (
    edge_of_slip_law,
    runaway_step_lower_bound,
    runaway_step_upper_bound,
)

LARGEST = 27.6
CORNERS = [(1.005, 1.0001), (1.005, 20.0), (50.0, 1.0001), (50.0, 20.0)]
BETWEEN = [(1.02, 2.0), (1.1, 1.3), (2.0, 1.5), (7.0, 4.0)]


def massless(b_over_a, ratio, law="slip"):
    """Return a slider with a sigma = Dc = 1, so that K = K Dc/(a sigma)."""
    K = ratio * (b_over_a - 1)
    return rs.SpringSlider(a=1e-3, b=1e-3 * b_over_a, Dc=1.0, sigma=1e3, K=K, M=0.0, law=law)


def runs_away(b_over_a, ratio, v, y):
    """Integrate the equations in slip from v = ln(V/V_lp) and y = ln(V theta/Dc)."""
    if y >= ratio:
        return True
    beta, c, kappa = b_over_a, b_over_a - 1, ratio * (b_over_a - 1)

    def rates(D, state):
        load = kappa * math.expm1(-state[0])
        return [beta * state[1] + load, c * state[1] + load]

    def escaped(D, state):
        return state[1] - ratio

    def turned(D, state):
        return rates(D, state)[0]

    escaped.terminal = turned.terminal = True
    turned.direction = -1
    path = solve_ivp(
        rates, (0, 1e7), [v, y], "DOP853", rtol=1e-12, atol=1e-13, events=(escaped, turned)
    )
    assert path.status == 1
    return path.t_events[0].size > 0


@pytest.mark.parametrize(("b_over_a", "ratio"), CORNERS + BETWEEN)
def test_only_motions_above_the_edge_run_away(b_over_a, ratio):
    """1e-7 below the edge the motion returns, 1e-7 above it does not."""
    edge = edge_of_slip_law(ratio * (b_over_a - 1), b_over_a, LARGEST)
    assert 0 < edge.kick_up < ratio
    lines = (lambda s: (-s, 0.0), lambda s: (s, s), lambda s: (-s, -s))
    for size, line in zip(edge, lines, strict=True):
        if np.isinf(size):
            assert not runs_away(b_over_a, ratio, *line(LARGEST))
            continue
        starts = line(size * (1 - 1e-7)), line(size * (1 + 1e-7))
        found = [runs_away(b_over_a, ratio, *start) for start in starts]
        assert found == [False, True]
    parameters = {"a": 1.0, "b": b_over_a, "Dc": 1.0, "sigma": 1.0, "K": ratio * (b_over_a - 1)}
    low, high = runaway_step_lower_bound(**parameters), runaway_step_upper_bound(**parameters)
    assert math.log(low) * (1 - 1e-9) < edge.step_up < math.log(high) * (1 + 1e-9)


@pytest.mark.parametrize(("largest", "kick"), [(1.9, np.inf), (2.1, 1.99731468)])
def test_thresholds_beyond_largest_are_inf(largest, kick):
    found = edge_of_slip_law(2.0 * 0.02, 1.02, largest)
    assert found.kick_up == pytest.approx(kick, rel=1e-8)
    assert found.step_up == np.inf


def test_escape_near_b_over_a_1():
    """ln V passes any limit long before the motion returns or runs away."""
    found = escape(massless(1.02, 2.0), 1e-6)
    assert math.log(found.step_up) == pytest.approx(5.354515, rel=1e-6, abs=0)
    assert float(found.kick_up) == pytest.approx(1.99731468, rel=1e-8)  # a sigma = 1
    assert found.step_down == 0
    assert found.kick_down == -np.inf
    assert found.outcome == "runaway"


@pytest.mark.parametrize("V_lp", [1e-6, 1.0])
def test_a_fast_run_that_turns_back_is_not_a_runaway(V_lp):
    """It returns from a speed above light's; after a slightly larger step it does not."""
    slider, step = massless(1.02, 2.0), 5.354515
    loading, t_end = rs.Loading.constant(V_lp), 1e4 / V_lp
    run = rs.simulate(slider, loading, t_end, V_start=V_lp * math.exp(-0.999 * step), rtol=1e-8)
    assert float(run.V_max) > 1e10 * 3e8
    assert float(run.V[-1]) == pytest.approx(V_lp, rel=1e-5)
    with pytest.raises(rs.QuasiStaticInstability):
        rs.simulate(slider, loading, t_end, V_start=V_lp * math.exp(-1.001 * step), rtol=1e-8)


def test_a_cycle_search_that_turns_back_is_not_a_runaway():
    """The start from V_lp/10 is 0.1 % on either side of the edge."""

    def beyond(ratio):
        return edge_of_slip_law(0.2 * ratio, 1.2, LARGEST).step_up - math.log(10)

    ratio = brentq(beyond, 1.0001, 4.0, xtol=1e-9)
    assert 0 < beyond(ratio * 1.001) < 0.01
    assert rs.limit_cycle(massless(1.2, ratio * 1.001), 1.0).status == STEADY_SLIDING
    with pytest.raises(rs.QuasiStaticInstability):
        rs.limit_cycle(massless(1.2, ratio * 0.999), 1.0)


def test_aging_law_above_K_c_qs_only_turns_back():
    loading = rs.Loading.constant(1.0)
    run = rs.simulate(massless(2.0, 1.01, "aging"), loading, 1e4, V_start=1 / 60, rtol=1e-8)
    assert 3e8 < float(run.V_max) < 1e200
    assert float(run.V[-1]) == pytest.approx(1.0, rel=1e-9)
    with pytest.raises(rs.QuasiStaticInstability):
        rs.simulate(massless(2.0, 0.8, "aging"), loading, 1e4, V_start=1 / 60, rtol=1e-8)
    # the speed overflows on the way, so the run is refused, but not as a runaway
    with pytest.raises(rs.SolverError, match="beyond double precision") as caught:
        rs.simulate(massless(2.0, 1.01, "aging"), loading, 1e6, V_start=1e-5, rtol=1e-8)
    assert not isinstance(caught.value, rs.QuasiStaticInstability)


def test_criteria_of_runaway():
    """Both sides of each criterion, and no runaway if friction does not weaken."""

    def runs_away(law, y, kappa, c):
        """Return the criterion at ln(V theta/Dc) = y, for any V; c = b/a - 1."""
        values = {"a": 1.0, "b": 1.0 + c, "Dc": 1.0, "mu0": 0.6, "V0": 1.0}
        p = LAWS[law].coefficients(1.0, SimpleNamespace(**values))
        found = {bool(LAWS[law].runs_away(v, (y - v,), kappa, p)) for v in (0.0, 0.25, -4.0)}
        assert len(found) == 1
        return found.pop()

    assert [runs_away("slip", y, 3.0, 2.0) for y in (1.499, 1.5)] == [False, True]
    edge = -math.log1p(-0.5)
    assert [runs_away("aging", edge + d, 1.0, 2.0) for d in (-1e-9, 1e-9)] == [False, True]
    assert not runs_away("aging", 1e3, 2.0, 2.0)
    for c in (0.0, -0.5):
        assert not runs_away("slip", -1e3, 1.0, c)
        assert not runs_away("aging", 1e3, 1.0, c)
