"""Continuation of fixed points on normal forms whose branches and special points are known."""

from typing import NamedTuple

import numpy as np
import pytest
from scipy.optimize import brentq

from ratestate.dynamics.continuation import arclength
from ratestate.dynamics.continuation.bifurcations import (
    FixedPointProblem,
    without_noise,
)


@pytest.fixture(autouse=True)
def long_steps(monkeypatch):
    """Steps as long as the curvature of the branch allows."""
    monkeypatch.setattr(arclength, "LARGEST_STEP", 0.2)


def follow(evaluate, u0, p0, *, stop, scale, tol=1e-8, noise=1e-10, **options):
    problem = FixedPointProblem(evaluate, np.asarray(scale), tol, noise)
    return arclength.follow_branch(problem, np.asarray(u0), p0, stop, **options)


class Orbit(NamedTuple):
    image: np.ndarray
    jacobian: np.ndarray
    ok: np.ndarray
    measures: dict


def planar(x_image, y_image, entries):
    """A map of the plane from functions of x, y, p; entries gives dP/du row by row."""

    def evaluate(u, p):
        x, y = u.T
        jacobian = np.stack([np.broadcast_to(e, x.shape) for e in entries(x, y, p)], -1)
        image = np.stack([x_image(x, y, p), y_image(x, y, p)], -1)
        return Orbit(image, jacobian.reshape(-1, 2, 2), np.full(len(u), True), {"sum": x + y})

    return evaluate


def line(image, slope):
    """A map of the line from functions of u and p."""

    def evaluate(u, p):
        values, slopes = image(u[:, 0], p), slope(u[:, 0], p)
        return Orbit(values[:, None], slopes[:, None, None], np.full(len(p), True), {"p": p})

    return evaluate


def beside(evaluate, multiplier):
    """The map with one more coordinate, which it multiplies."""

    def evaluate_both(u, p):
        orbit = evaluate(u[:, :-1], p)
        image = np.column_stack([orbit.image, multiplier * u[:, -1]])
        jacobian = np.zeros((*u.shape, u.shape[1]))
        jacobian[:, :-1, :-1], jacobian[:, -1, -1] = orbit.jacobian, multiplier
        return orbit._replace(image=image, jacobian=jacobian)

    return evaluate_both


def specials(branch):
    return [point.special for point in branch.points if point.special]


def special(branch, name):
    (point,) = [point for point in branch.points if point.special == name]
    return point


EXACT = 1e-15  # what `noise` is of maps that are a formula

parabola = line(lambda u, p: u + p - u**2, lambda u, p: 1 - 2 * u)
logistic = line(lambda u, p: p * u * (1 - u), lambda u, p: p * (1 - 2 * u))
delayed_logistic = planar(
    lambda x, y, p: p * x * (1 - y),
    lambda x, y, p: x,
    lambda x, y, p: (p * (1 - y), -p * x, 1.0, 0.0),
)


def test_fold():
    branch = follow(parabola, [0.9], 0.81, stop=-1.0, scale=[1.0])
    assert specials(branch) == ["fold", "start"]
    assert branch.end == "start"
    assert branch.points[-1].p == 0.81
    assert branch.points[-1].u[0] == pytest.approx(-0.9, abs=1e-8)
    u, p = np.array([point.y for point in branch.points]).T
    assert np.abs(p - u**2).max() < 2e-8
    assert np.all(np.diff(u) < 0)
    fold = special(branch, "fold")
    assert abs(fold.p) < 1e-13
    assert abs(fold.u[0]) < 1e-9
    assert fold.multipliers[0] == pytest.approx(1, abs=1e-9)
    for point in branch.points:
        assert point.multipliers[0] == pytest.approx(1 - 2 * point.u[0], abs=1e-14)
        assert point.measures == {"p": point.p}
        assert 1e-11 < point.error <= 1e-8  # the noise that is assumed, at least
    near = np.abs(u) < 0.5  # the curve turns by 90 degrees here
    assert 10 < near.sum() < 40


def test_a_fast_excursion_of_a_multiplier_is_not_stepped_over():
    """Below -1 for 0.04 in p, which a step of the usual 0.2 would pass."""

    def multiplier(p):
        return -0.5 - 0.8 * np.exp(-(((p - 1) / 0.05) ** 2)) + 0.6 * (1 + np.tanh((p - 1.1) / 0.03))

    branch = follow(
        line(lambda u, p: multiplier(p) * u, lambda u, p: multiplier(p)),
        [0.0],
        0.0,
        stop=2.0,
        scale=[1.0],
        noise=EXACT,
    )
    assert specials(branch) == ["period_doubling", "period_doubling", "stop"]
    expected = [
        brentq(lambda p: multiplier(p) + 1, *ends, xtol=1e-14) for ends in ((0.9, 1), (1, 1.1))
    ]
    found = [point.p for point in branch.points if point.special == "period_doubling"]
    assert found == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize(("start", "stop"), [(1.5, 2.6), (2.6, 1.5)])
@pytest.mark.parametrize("third", [0.3, -1e-200, 2e4])
def test_delayed_logistic_map_has_a_torus_point(start, stop, third):
    evaluate = beside(delayed_logistic, third)
    u0 = [1 - 1 / start, 1 - 1 / start, 0.0]
    branch = follow(evaluate, u0, start, stop=stop, scale=np.ones(3), noise=EXACT)
    assert specials(branch) == ["torus", "stop"]
    torus = special(branch, "torus")
    assert torus.y == pytest.approx([0.5, 0.5, 0, 2], abs=1e-12)
    pair = torus.multipliers[torus.multipliers.imag != 0]
    assert np.abs(pair) == pytest.approx([1, 1], abs=1e-12)
    assert np.sort(np.angle(pair)) == pytest.approx([-np.pi / 3, np.pi / 3])


def test_a_neutral_saddle_is_not_a_torus_point():
    """Real multipliers p and 1/2, whose product passes 1 at p = 2."""
    saddle = planar(
        lambda x, y, p: p * x, lambda x, y, p: 0.5 * y, lambda x, y, p: (p, 0.0, 0.0, 0.5)
    )
    branch = follow(saddle, [0.0, 0.0], 1.5, stop=3.0, scale=[1.0, 1.0])
    assert specials(branch) == ["stop"]
    assert branch.points[-1].multipliers == pytest.approx([3, 0.5])


def test_a_crossing_branch_is_not_a_fold():
    """On u = 0 of the transcritical map a multiplier passes 1, and p goes on."""
    transcritical = line(lambda u, p: u + p * u - u**2, lambda u, p: 1 + p - 2 * u)
    branch = follow(transcritical, [0.0], -0.513, stop=0.7, scale=[1.0])
    assert specials(branch) == ["stop"]
    assert all(point.u[0] == pytest.approx(0, abs=1e-9) for point in branch.points)


def flow(l1, l2):
    """Map after time 2 pi of r' = p r + l1 r^3 + l2 r^5, the radius of a Hopf normal form.

    Runge-Kutta steps have the fixed points of the flow exactly, whatever their size.
    """

    def rate(r, p):
        return p * r + l1 * r**3 + l2 * r**5, p + 3 * l1 * r**2 + 5 * l2 * r**4

    def evaluate(u, p):
        r, slope = u[:, 0], np.ones(len(p))
        h = 2 * np.pi / 64
        for _ in range(64):
            k, dk, r_stage, slope_stage = 0.0, 0.0, r, slope
            for weight, reach in ((1, 0.5), (2, 0.5), (2, 1.0), (1, 0.0)):
                value, derivative = rate(r_stage, p)
                k, dk = k + weight * value, dk + weight * derivative * slope_stage
                r_stage, slope_stage = (
                    r + h * reach * value,
                    slope + h * reach * derivative * slope_stage,
                )
            r, slope = r + h / 6 * k, slope + h / 6 * dk
        return Orbit(r[:, None], slope[:, None, None], u[:, 0] > 0, {})

    return evaluate


def test_subcritical_hopf_with_its_fold_of_cycles():
    """0 = p + r^2/2 - r^4: the fold is at r^2 = 1/4, p = -1/16, and the Hopf point at 0."""
    start = 0.5
    r = np.sqrt((0.5 + np.sqrt(0.25 + 4 * start)) / 2)
    branch = follow(
        flow(0.5, -1.0),
        [r],
        start,
        stop=-1.0,
        scale=[1.0],
        amplitude=lambda point: point.u[0] - 1e-3,
    )
    assert branch.end == "hopf"
    assert specials(branch) == ["fold"]
    assert special(branch, "fold").y == pytest.approx([0.5, -1 / 16], abs=1e-8)
    assert special(branch, "fold").p == pytest.approx(-1 / 16, abs=1e-12)
    assert branch.points[-1].u[0] == pytest.approx(1e-3, abs=1e-8)
    assert -1e-6 < branch.points[-1].p < -4e-7
    stable = [abs(point.multipliers[0]) < 1 for point in branch.points]
    fold = specials_at(branch)[0]
    assert all(stable[:fold])
    assert not any(stable[fold + 1 :])


def specials_at(branch):
    return [i for i, point in enumerate(branch.points) if point.special]


def beyond(evaluate, edge):
    """The map without an image where p > edge."""

    def bounded(u, p):
        orbit = evaluate(u, p)
        gone = p > edge
        orbit.image[gone] = np.nan
        return orbit._replace(ok=orbit.ok & ~gone)

    return bounded


def test_the_branch_is_kept_up_to_where_the_map_ends():
    branch = follow(beyond(logistic, 2.71), [0.5], 2.0, stop=3.5, scale=[1.0])
    assert branch.end == "no return"
    assert specials(branch) == []
    assert 2.71 - 1e-5 < branch.points[-1].p <= 2.71
    assert branch.points[-1].u[0] == pytest.approx(1 - 1 / branch.points[-1].p, abs=1e-8)


@pytest.mark.parametrize(
    ("p", "kept"),
    [
        ([0, 5, 3, 5, 0], [1, 2, 3]),
        ([0, 5, 4.5, 5, 0], [3]),  # of three folds on a flat top one is real
        ([0, 5, 4.5, 9], []),
        ([0, 5, 4.5], []),
        ([0, 0.5, -9], []),
        ([0, 5, -9], [1]),
    ],
)
def test_folds_beyond_noise(p, kept):
    blank = follow(parabola, [1.0], 1.0, stop=0.5, scale=[1.0]).points[0]._replace(error=1.0)
    inner = [blank._replace(p=value, special="fold") for value in p[1:-1]]
    points = [blank._replace(p=p[0]), *inner, blank._replace(p=p[-1])]
    found = without_noise(points)
    assert [point.p for point in found] == p
    assert [i for i, point in enumerate(found) if point.special == "fold"] == kept


def test_a_start_without_a_solution_has_no_branch():
    nowhere = line(lambda u, p: u + 1 + p**2 + u**2, lambda u, p: 1 + 2 * u)
    assert follow(nowhere, [0.3], 0.0, stop=1.0, scale=[1.0]) == ([], "no convergence")
    on_a_fold = follow(parabola, [1e-9], 1e-18, stop=-1.0, scale=[1.0])
    assert on_a_fold == ([], "no convergence")
    assert follow(beyond(logistic, 1.0), [0.5], 2.0, stop=3.0, scale=[1.0]) == ([], "no return")


@pytest.mark.parametrize("slope", [0.0, 1.0])
def test_a_branch_that_breaks_off(slope):
    """At p = 0.5, to go on elsewhere: as near as a corrector gets, or very far."""

    def image(u, p):
        return np.where(p < 0.5, 0.5 * u + slope * p, 0.5 * u + slope * p + 0.5 + 1e3 * slope)

    jump = line(image, lambda u, p: np.full_like(u, 0.5))
    branch = follow(jump, [0.0], 0.0, stop=1.0, scale=[1.0])
    assert branch.end == "no convergence"
    assert 0.5 - 1e-4 < branch.points[-1].p < 0.5
    assert branch.points[-1].u[0] == pytest.approx(2 * slope * branch.points[-1].p, abs=1e-8)
