"""The return map and its derivative: differences, SciPy, lanes."""

import math

import numpy as np
import pytest
from dimensionless import P1, P2, P4A, P4B, jacobian, make_system, random_sliders, rates
from scipy.integrate import solve_ivp

import ratestate as rs
from ratestate.dynamics.cycles import shooting
from ratestate.dynamics.cycles.attractor import find_attractors, steady_start
from ratestate.dynamics.cycles.shooting import multipliers, return_map
from ratestate.dynamics.cycles.system import state
from ratestate.engine import dispatch
from ratestate.engine.model import FINISHED, NOT_FINITE, RUNAWAY, STEADY_SLIDING, STEP_LIMIT

LAWS = pytest.mark.parametrize("law", ["slip", "aging"])


# The derivative -----------------------------------------------------------------------------------


@LAWS
@pytest.mark.parametrize("eta", [1e-20, 1e-7, 1e-3, 1.0, 1e4])
def test_derivative_by_differences(law, eta):
    """Of the map, the period and the lowest stress; by differences of much finer returns."""
    system, y = random_sliders(law, 12, eta)
    returns = return_map(system, y, 1e-9)
    assert returns.has_returned.all()
    assert np.abs(returns.jacobian[:, 0, 0]).max() > 1e-4  # there is something to see
    # eta d G is lost in the rounding of x where eta is small, and so is G
    for column, name in enumerate("ab" if eta > 1e-4 else "a"):
        perturbations = state(system, np.eye(2)[[column] * len(y)])
        d = 3e-5 * (np.abs(y).max(axis=1) if name == "a" else 1 / (1 + eta / 10))
        sizes = d * np.linspace(0.8, 1.2, 5)[:, None]  # on average rounding has less effect
        ends = [
            [return_map(system, y + (e * perturbations.T).T, 1e-12) for e in (size, -size)]
            for size in sizes
        ]
        found = [(returns.jacobian[:, 0, :], lambda end: end.image[:, 0], 1e-5)]
        if not 1e-9 <= eta <= 1e-4:  # between, little is left of G but rounding
            near = 1e-5 + (3e-8 / eta if eta > 1e-4 else 0.0)  # eta G is a difference
            found.append((returns.jacobian[:, 1, :], lambda end: end.image[:, 1], near))
        found += [
            (returns.gradients[number], lambda end, number=number: end.numbers[number], 1e-5)
            for number in ("period", "x_low")
        ]
        for slopes, value, near in found:
            changes = np.array([value(up) - value(down) for up, down in ends])
            off = np.abs(slopes[:, column] - (changes / (2 * sizes)).mean(axis=0))
            rounding = 2e-12 * np.maximum(np.abs(value(ends[0][0])), np.abs(y).max(axis=1)) / d
            assert (off < near * np.abs(slopes).max(axis=1) + rounding).all(), (off, slopes)


@LAWS
def test_errors_of_returns_follow_the_tolerance(law):
    """Errors of the section's next point and of the period: near the tolerance, on both sides."""
    system, y = random_sliders(law, 24)
    exact = return_map(system, y, 1e-12)
    for rtol in (1e-5, 1e-7, 1e-9):
        found = return_map(system, y, rtol)
        off = np.abs(found.image[:, 0] - exact.image[:, 0]) / np.hypot(y[:, 0], y[:, 2])
        assert off.max() < 10 * rtol
        assert off.max() > 1e-2 * rtol  # the test is not blind
        late = np.abs(found.numbers["period"] / exact.numbers["period"] - 1)
        assert rtol / 100 < late.max() < 10 * rtol
        steps = np.log(exact.numbers["steps"] / found.numbers["steps"])
        order = np.log(rtol / 1e-12) / steps.mean()
        assert 5.0 < order < 8.0  # of steps of fifth order, and of twelfth


# SciPy's variational equations --------------------------------------------------------------------


class Return:
    """One return from the section's u by SciPy: the state with two perturbations and the trace.

    In the perturbations' rows the Jacobian given to Radau leaves out their dependence on the
    state, which costs it iterations and no accuracy.
    """

    def __init__(self, law, kappa, beta, eta, u, t_max, method, rtol):
        f, J_of = rates(law, kappa, beta, eta), jacobian(law, kappa, beta, eta)

        def all_rates(t, s):
            J = J_of(s[:3])
            return np.concatenate([f(s[:3]), J @ s[3:6], J @ s[6:9], [np.trace(J)]])

        def all_slopes(t, s):
            J = np.zeros((10, 10))
            J[:3, :3] = J[3:6, 3:6] = J[6:9, 6:9] = J_of(s[:3])
            return J

        def rises(t, s):
            return s[1]

        def falls(t, s):
            return s[1]

        rises.direction, rises.terminal, falls.direction = 1.0, True, -1.0
        settings = {"rtol": rtol, "atol": 1e-2 * rtol}
        settings |= {"jac": all_slopes} if method == "Radau" else {}
        psi, G = u
        s = [beta * psi + eta * G, 0, psi, beta, 0, 1, eta, 0, 0, 0]
        first = solve_ivp(all_rates, (0, 1e-3 * t_max), s, method, **settings)
        run = solve_ivp(
            all_rates,
            (first.t[-1], t_max),
            first.y[:, -1],
            method,
            events=(rises, falls),
            **settings,
        )
        end = run.y_events[0][0]
        x, _, psi = end[:3]
        flow = f(end[:3])
        # the perturbed orbits' own points of the section
        moved = [z - flow * (z[1] / flow[1]) for z in (end[3:6], end[6:9])]
        self.period, self.trace, self.x_low = run.t_events[0][0], end[9], run.y_events[1][-1][0]
        self.image = np.array([psi, (x - beta * psi) / eta])
        self.jacobian = np.array([[z[2], (z[0] - beta * z[2]) / eta] for z in moved]).T


def both_returns(law, parameters, method, rtol):
    """Find the cycle and return its return map, the numbers of this, and SciPy's return."""
    system = make_system(law, *parameters)
    attractors = find_attractors(system, steady_start(system), 1e-10, None)
    assert attractors.status == FINISHED
    returns = return_map(system, state(system, attractors.u), 1e-12)
    numbers = {name: value[0] for name, value in returns.numbers.items()}
    exact = Return(law, *parameters, attractors.u[0], 1.2 * numbers["period"], method, rtol)
    return returns, numbers, exact


# K Dc/(a sigma), b/a and eta of numerics.md, section 5


@pytest.mark.parametrize(
    ("law", "parameters"),
    [
        ("slip", P1),
        ("aging", P4A),
        ("slip", (0.9 * 0.9 * 4, 1.9, 3.0)),
        ("aging", (0.8 * 0.5 * 41, 1.5, 40.0)),
        ("slip", (0.97 * 2.0 * 7, 3.0, 6.0)),
        ("aging", (0.97 * 2.0 * 7, 3.0, 6.0)),
        ("slip", (0.9 * 0.2 * 1001, 1.2, 1000.0)),
    ],
)
def test_derivative_of_smooth_cycles(law, parameters):
    """Against DOP853 through the variational equations: both multipliers, Liouville's product."""
    returns, numbers, exact = both_returns(law, parameters, "DOP853", 1e-13)
    for name in ("period", "x_low"):
        assert numbers[name] == pytest.approx(getattr(exact, name), rel=1e-11)
    np.testing.assert_allclose(returns.image[0], exact.image, rtol=1e-10)
    np.testing.assert_allclose(
        returns.jacobian[0], exact.jacobian, rtol=0, atol=1e-9 * np.abs(exact.jacobian).max()
    )
    first, second = multipliers(returns)[0]
    theirs = np.linalg.eigvals(exact.jacobian)
    theirs = theirs[np.argsort(-np.abs(theirs))]
    assert first == pytest.approx(theirs[0], rel=1e-9)
    assert second == pytest.approx(theirs[1], rel=1e-9, abs=1e-12)
    assert numbers["trace"] == pytest.approx(exact.trace, rel=1e-10)
    if exact.trace > math.log(1e-8):
        product = np.linalg.det(exact.jacobian)
        assert abs(first * second) == pytest.approx(product, rel=1e-6)
        assert np.linalg.det(returns.jacobian[0]) == pytest.approx(product, rel=1e-6)


@pytest.mark.parametrize(
    ("law", "parameters", "multiplier"),
    [("slip", P2, 1.873923e-4), ("aging", P4B, 0.15171038)],
    ids=["P2", "P4b"],
)
def test_derivative_of_stick_slip(law, parameters, multiplier):
    """Against Radau; rounding of x - beta psi over eta leaves it no digits of G."""
    returns, numbers, exact = both_returns(law, parameters, "Radau", 3e-9)
    for name in ("period", "x_low"):
        assert numbers[name] == pytest.approx(getattr(exact, name), rel=1e-10)
    assert returns.image[0, 0] == pytest.approx(exact.image[0], rel=1e-10)
    assert numbers["trace"] == pytest.approx(exact.trace, rel=1e-9)
    theirs = np.linalg.eigvals(exact.jacobian)
    first, second = multipliers(returns)[0]
    assert first == pytest.approx(theirs[np.argmax(np.abs(theirs))], rel=1e-6)
    assert first == pytest.approx(multiplier, rel=1e-6)  # Radau at 1e-11
    assert second == 0  # exp of minus 1e9 and more


# What ends a return -------------------------------------------------------------------------------


@LAWS
def test_each_return_has_its_status(law):
    kinds = [
        (0.8, 0.1, np.inf),  # comes back
        (3.0, 0.1, np.inf),  # spirals towards steady sliding
        (0.1, 0.0, 20.0),  # runs away, having no mass
        (math.nan, 0.1, np.inf),
    ]
    kappa, eta, v_limit = np.array(kinds).T
    system = make_system(law, kappa, 2.0, eta, v_limit)
    y = state(system, np.array([[0.5, 1.0], [1e-3, 1e-3], [0.5, 1.0], [0.5, 1.0]]))
    returns = return_map(system, y, 1e-6, steady_tol=2e-3)
    assert returns.status.tolist() == [FINISHED, STEADY_SLIDING, RUNAWAY, NOT_FINITE]
    assert np.isnan(returns.image[1:]).all()
    assert np.isfinite(returns.image[0]).all()
    assert returns.has_returned.tolist() == [True, False, False, False]
    # nothing is steady that is not asked to be
    assert return_map(system, y, 1e-6).status[1] == FINISHED


def test_step_limit(monkeypatch):
    system, y = random_sliders("slip", 3)
    for most in (5, 12):
        monkeypatch.setattr(shooting, "MAX_STEPS_OF_RETURN", most)
        returns = return_map(system, y, 1e-6)
        assert returns.status.tolist() == [STEP_LIMIT] * 3
        assert returns.numbers["steps"].tolist() == [most] * 3


@LAWS
def test_a_return_goes_from_maximum_to_maximum(law):
    """From one maximum to the next, not to itself; from between two of them to the second."""
    smooth, y = random_sliders(law, 4, 1.0)
    returns = return_map(smooth, y, 1e-11)
    period = returns.numbers["period"]
    between = y.copy()
    for i, (kappa, beta, eta) in enumerate(zip(smooth.kappa, smooth.beta, smooth.eta, strict=True)):
        f, J = rates(law, kappa, beta, eta), jacobian(law, kappa, beta, eta)
        settings = {"jac": lambda t, y, J=J: J(y), "rtol": 1e-13, "atol": 1e-15}
        span = (0, 0.4 * period[i])
        run = solve_ivp(lambda t, y, f=f: f(y), span, y[i], "LSODA", **settings)
        between[i] = run.y[:, -1]
    rest = return_map(smooth, between, 1e-11)
    np.testing.assert_allclose(rest.image, returns.image, rtol=1e-9)
    np.testing.assert_allclose(rest.numbers["period"], 0.6 * period, rtol=1e-9)


# Lanes --------------------------------------------------------------------------------------------


def all_numbers(returns):
    numbers, gradients = returns.numbers.values(), returns.gradients.values()
    return np.column_stack([returns.status, *numbers, *gradients, returns.jacobian.reshape(-1, 4)])


@LAWS
@pytest.mark.parametrize("observed", [False, True])
def test_returns_have_the_same_bits_in_any_batch(law, observed, monkeypatch):
    system, y = random_sliders(law, 40)
    rtol = 10 ** np.random.default_rng(3).uniform(-9, -4, 40)
    period = np.where(np.arange(40) % 7 == 0, np.nan, 7.0) if observed else None  # some have none

    def run(pick):
        mine = system.at(pick)
        guess = None if period is None else period[pick]
        return all_numbers(return_map(mine, y[pick], rtol[pick], observe=observed, period=guess))

    whole = run(np.arange(40))
    rng = np.random.default_rng(4)
    for n in (1, 2, 15, 16, 17, 33):
        pick = rng.permutation(40)[:n]
        np.testing.assert_array_equal(run(pick), whole[pick])
    np.testing.assert_array_equal(run(np.full(35, 7)), whole[np.full(35, 7)])
    for cores in (1, 2, 5):
        monkeypatch.setattr(dispatch, "cores", lambda cores=cores: cores)
        pick = rng.permutation(np.tile(np.arange(40), 3))
        np.testing.assert_array_equal(run(pick), whole[pick])


@pytest.mark.parametrize("rtol", [1e-6, 1e-9])
def test_a_sudden_arrest_does_not_end_a_return(rtol):
    """V falls through V_lp while S_v dv/dT = -S_psi dpsi/dT has the other sign; by a run."""
    parameters = {"a": 0.012037, "b": 0.054124, "Dc": 1.1553e-4, "sigma": 1.3986e6, "mu0": 0.62545}
    parameters |= {"K": 1.95253e7, "M": 4.92037, "V0": 2.20713e-6, "b2": -0.0038346}
    parameters |= {"Dc2": 6.75344e-6, "V1": 1.602066e-4, "V2": 2.272778e-5}
    V = 8.17984e-5
    slider = rs.SpringSlider(law="two-state-slip", friction_form="cut-off", **parameters)
    cycle = rs.limit_cycle(slider, V, rtol=rtol)
    run = rs.simulate(slider, rs.Loading.constant(V), 1500, V_start=V / 10, rtol=rtol, times=[1500])
    assert int(cycle.returns) == int(run.returns) == 1
    assert float(cycle.period) == pytest.approx(90.9, abs=0.2)
    assert float(cycle.period) == pytest.approx(1 / float(run.frequency), rel=2 * rtol)
    assert float(cycle.amplitude) == pytest.approx(float(run.amplitude), rel=2 * rtol)
    assert float(cycle.error) < rtol
