"""One step with its derivative, against differences of the march's step."""

import functools
import math
from typing import NamedTuple

import numpy as np
import pytest
from machine_control import Formula

from ratestate.engine import rodas5p as R
from ratestate.engine import tangent as T
from ratestate.friction.laws import LAWS as FORMULAS
from ratestate.friction.point import point_at

LAWS = pytest.mark.parametrize("law", ["slip", "aging"])


class Step(NamedTuple):
    """The result of `tangent.step` with two perturbations."""

    y: tuple
    w_and_e: tuple
    z1: tuple
    z2: tuple
    error: tuple
    dense: tuple
    trace: float


@functools.cache
def steps_of(law):
    """Return `tangent.step`, with two perturbations, and `rodas5p.step`, compiled."""

    def step(y, z, h, kappa, eta, p):
        new, z, *others = T.step(point_at(law, p, y, kappa, eta), z, h)
        return new.y, (new.w, *new.e), *z, *others

    def base_step(y, h, kappa, eta, p):
        new, *others = R.step(point_at(law, p, y, kappa, eta), 1.0, 0.0, h)
        return (new.y, new.w, new.e), *others

    y, p, others = (0.0,) * 3, (0.0,), [0.0] * 3
    return Formula(step, y, (y, y), *others, p), Formula(base_step, y, *others, p)


def step(y, y1, y2, h, system):
    """With two perturbations."""
    law, *others = system
    return Step(*steps_of(law)[0](tuple(y), (tuple(y1), tuple(y2)), h, *others))


def base_step(y, h, system):
    law, *others = system
    return steps_of(law)[1](tuple(y), h, *others)


def system_of(law, kappa, beta, eta):
    """Return the arguments of a step that describe the slider."""
    return FORMULAS[law], kappa, eta, (beta,)


def random_step(law, rng, eta=None, spread=1.0, slaved=False):
    """Return y, h and system of a step that meets a very loose tolerance."""
    kappa, beta = 10 ** rng.uniform(-1.5, 1), rng.uniform(1.1, 5)
    eta = 10 ** rng.uniform(-5, 3) if eta is None else eta
    v, psi = spread * rng.normal(size=2)
    g = 0.0 if slaved else min(1.0, eta) * rng.normal()
    y, h, system = np.array([v + beta * psi + g, v, psi]), 1.0, system_of(law, kappa, beta, eta)
    while not np.abs(base_step(tuple(y), h, system)[1]).max() < 1e-4:
        h /= 4
    return y, h, system


# The engine's own step ----------------------------------------------------------------------------


@LAWS
@pytest.mark.parametrize("eta", [0.0, 1e-18, 1e-6, 0.1, 30.0, 1e4])
def test_base_step_is_that_of_a_march(law, eta):
    rng = np.random.default_rng(22)
    for _ in range(20):
        y, h, system = random_step(law, rng, eta, spread=2.0, slaved=eta < 1e-10)
        ours = step(y, (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), h, system)
        (y_new, w, e), error, dense, _, _ = base_step(tuple(y), h, system)
        np.testing.assert_allclose(ours.y, y_new, rtol=0, atol=1e-13)
        np.testing.assert_allclose(ours.w_and_e, (w, *e), rtol=1e-13)
        assert len(e) == (law == "aging")
        np.testing.assert_allclose(ours.error, error, rtol=0, atol=1e-12)
        np.testing.assert_allclose(ours.dense, dense, rtol=0, atol=1e-11)


def at_rest(law, rng):
    """Return y, h and system at v < -600: v changes by some units, x and psi do not."""
    v, psi, beta, g = rng.uniform(-900, -700), rng.normal(), rng.uniform(1.1, 5), rng.normal()
    eta = 10 ** rng.uniform(0, 3)
    y, system = np.array([v + beta * psi + g, v, psi]), system_of(law, 1.0, beta, eta)
    return y, rng.uniform(0.1, 1) * eta * math.exp(-600.0), system


def differences(y, along, h, system, size):
    """Return central differences of the march's step, extrapolated from two sizes."""

    def central(d):
        up, down = (base_step(tuple(y + sign * d * along), h, system)[0][0] for sign in (1, -1))
        return (np.array(up) - np.array(down)) / (2 * d)

    return (4 * central(size) - central(2 * size)) / 3


@LAWS
@pytest.mark.parametrize("place", ["moving", "slaved", "held", "rest"])
def test_derivative_of_the_engines_step(law, place):
    """Where inertia matters, where it is small, where it is below rounding, and at rest."""
    rng = np.random.default_rng(23)
    for _ in range(30):
        if place == "moving":
            y, h, system = random_step(law, rng)
        elif place == "slaved":
            y, h, system = random_step(law, rng, 10 ** rng.uniform(-12, -7), slaved=True)
        elif place == "held":
            y, h, system = random_step(law, rng, 10 ** rng.uniform(-30, -22), slaved=True)
        else:  # w is a constant there
            y, h, system = at_rest(law, rng)
        y1, y2 = rng.normal(size=(2, 3))
        (beta,) = system[3]
        if place in ("slaved", "held"):  # off v = x - beta psi all is over within a step
            y1[0], y2[0] = y1[1] + beta * y1[2], y2[1] + beta * y2[2]
        got = step(y, y1, y2, h, system)
        for along, z in ((y1, got.z1), (y2, got.z2)):
            exact = differences(y, along, h, system, 1e-2 if place == "rest" else 1e-4)
            np.testing.assert_allclose(z, exact, rtol=0, atol=5e-9 * np.abs(exact).max())
        x, v, psi = got.y
        if place == "held":
            assert v == pytest.approx(x - beta * psi, rel=1e-14, abs=1e-14)
            for z in (got.z1, got.z2):
                assert z[1] == pytest.approx(z[0] - beta * z[2], rel=1e-13, abs=1e-13)
