"""Branches of limit cycles under any law: along K, speed, and what parameters a law has alone."""

import numpy as np
import pytest
from textbook import OF_LAW

import ratestate as rs
from ratestate.dynamics.cycles.shooting import return_map
from ratestate.dynamics.cycles.system import linear_section, small_amplitude, state, system_of
from ratestate.friction.laws import LAWS

V = 3e-3
COMMON = {"a": 0.003, "b": 0.006, "Dc": 1e-5, "sigma": 2e6, "M": 3e3}
#: laws for which test_branch.py has no tests: with two states, and with friction that acts back
OTHERS = pytest.mark.parametrize("law", ["two-state-slip", "nagata"])


def slider(law, **changes):
    values = COMMON | OF_LAW[law] | {"K": 5e8} | changes
    return rs.SpringSlider(**values, law=law)


def agree(branch, slider, parameter, points, rtol):
    """Whether these points are the cycles that `limit_cycle` reaches there."""
    for i in points:
        point = branch.isel(point=i)
        there = {parameter: float(point[parameter])}
        V_lp = there.pop("V_lp", V)
        cycle = rs.limit_cycle(slider.replace(**there), V_lp, rtol=rtol / 100)
        for name in ("amplitude", "period", "V_max", "V_min", "inertia"):
            assert float(point[name]) == pytest.approx(float(cycle[name]), rel=10 * rtol), name
        np.testing.assert_allclose(point.multipliers, cycle.multipliers, atol=1e-5)
        assert point.stable


@OTHERS
def test_a_branch_from_the_hopf_point(law):
    """It leaves as `hopf` says, and further on its points are the cycles of `limit_cycle`."""
    case = slider(law)
    K_c, hopf = case.K_c(V), rs.hopf(case, V_lp=V)
    branch = rs.continue_cycle(case, "K", 1.02 * K_c, 0.8 * K_c, V_lp=V, rtol=1e-7)
    assert [str(name) for name in branch.special.values if name] == ["hopf", "stop"]
    assert float(branch.K[0]) == pytest.approx(K_c, rel=1e-12)
    assert float(branch.K[-1]) == pytest.approx(0.8 * K_c, rel=1e-15)
    ratio = branch.amplitude / np.sqrt(np.abs(branch.K / K_c - 1)) / hopf.amplitude_coefficient
    r = 0.5 * np.log(branch.V_max / branch.V_min)
    near = (r > 0) & (r < 0.15)
    assert near.sum() > 3
    assert (np.abs(ratio - 1)[near] < 0.6 * r[near] ** 2 + 1e-5).all()
    assert float(branch.error.max()) <= 1e-7
    n = branch.point.size
    agree(branch, case, "K", (n // 2, n - 1), 1e-7)
    at_hopf = branch.isel(point=0)
    assert float(at_hopf.frequency) == pytest.approx(float(hopf.frequency), rel=1e-11)
    # of the other multipliers, as eigenvalues beside the Hopf point say
    modes = rs.stability(case.replace(K=K_c), V).eigenvalues.values
    others = np.exp(modes[np.argsort(np.abs(modes.imag), kind="stable")] * float(at_hopf.period))
    wanted = np.sort(np.abs(others[: len(modes) - 2]))[::-1]
    np.testing.assert_allclose(np.abs(at_hopf.multipliers[1:]), wanted, rtol=1e-6, atol=1e-12)
    assert float(at_hopf.inertia) == pytest.approx(float(branch.inertia[1]), rel=0.05)


@pytest.mark.parametrize(
    ("law", "parameter", "stop"),
    [
        ("two-state-slip", "b2", 1e-4),
        ("nagata", "c", 0.3),
        ("two-state-aging", "V_lp", 1e-2),
    ],
)
def test_a_branch_along_a_parameter_of_the_law(law, parameter, stop):
    case = slider(law, K=0.7 * slider(law).K_c(V))
    start = V if parameter == "V_lp" else getattr(case, parameter)
    settings = {} if parameter == "V_lp" else {"V_lp": V}
    branch = rs.continue_cycle(case, parameter, start, stop, rtol=1e-6, **settings)
    assert float(branch[parameter][0]) == pytest.approx(start, rel=1e-15)
    assert float(branch[parameter][-1]) == pytest.approx(stop, rel=1e-15)
    assert str(branch.special[-1].values) == "stop"
    agree(branch, case, parameter, (0, branch.point.size // 2, branch.point.size - 1), 1e-6)


def test_where_the_return_map_varies_fast_with_the_parameter():
    """V_cut matters at the slowest speed alone, and one multiplier is 385."""
    case = slider("kato-tullis", K=3e8, V_cut=1e-8)
    branch = rs.continue_cycle(case, "V_cut", 1e-6, 1e-4, V_lp=1e-3, rtol=1e-5)
    assert str(branch.special[-1].values) == "stop"
    assert 380.0 < float(np.abs(branch.multipliers).max()) < 390.0
    folds = branch.V_cut[branch.special == "fold"].values
    assert folds == pytest.approx([1.301445e-5, 1.125302e-6], rel=1e-5)


def test_a_branch_along_which_the_effects_of_two_states_cancel():
    """Effects of two states cancel at b2 = 0.0155: no sign of a Hopf point; then period doubles."""
    case = slider("two-state-slip", K=8e8)
    branch = rs.continue_cycle(case, "b2", 0.01, 0.03, V_lp=V, rtol=1e-5)
    assert str(branch.special[-1].values) == "stop"
    doublings = branch.b2[branch.special == "period_doubling"].values
    assert len(doublings) >= 1
    (first, *_) = doublings
    for b2, returns in ((0.98 * first, 1), (1.02 * first, 2)):
        assert int(rs.limit_cycle(case.replace(b2=b2), V, rtol=1e-6).returns) == returns


@pytest.mark.parametrize("name", LAWS)
def test_small_amplitudes_agree_with_linear_equations(name):
    """An orbit from the section of the linear mode comes back to it at the edge of stability."""
    case = slider(name)
    columns = {**case.values, "K": case.K_c(V), "V_lp": V}
    system = system_of(name, **{symbol: np.array([x]) for symbol, x in columns.items()})
    u = 1e-5 * linear_section(system)
    np.testing.assert_allclose(small_amplitude(system, u), 1e-5, rtol=1e-12)
    returns = return_map(system, state(system, u), np.full(1, 1e-13))
    np.testing.assert_allclose(returns.image / u, 1.0, atol=1e-4)
    waves = return_map(system, state(system, u), np.full(1, 1e-13), observe=True, period=np.ones(1))
    law, p, v_max = system.friction_law, system.coefficients, waves.numbers["v_max"]
    assert np.log(law.speed(v_max, law.reference_state, p)[0]) == pytest.approx(1e-5, rel=1e-4)


def test_parameters_of_a_branch_that_are_refused():
    with pytest.raises(rs.ParameterError, match=r"parameter = 'c' .* Dc, b2, Dc2\.$"):
        rs.continue_cycle(slider("two-state-slip"), "c", 1.0, 2.0, V_lp=V)
