"""Derivatives of the equations of motion, compared with differences in mpmath."""

import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import exact_functions  # noqa: F401  (so that formulas take mpmath's numbers)
import mpmath as mp
import numpy as np
import pytest

from ratestate.engine.tangent import trace_of
from ratestate.friction.composition import composed, forms_of
from ratestate.friction.laws import LAWS
from ratestate.friction.point import point_at

SLIDER = {"a": 0.01, "b": 0.015, "Dc": 1e-5, "mu0": 0.6, "V0": 1e-6, "sigma": 5e6, "damping": 5e6}
OWN = {"b2": 0.003, "Dc2": 3e-5, "c": 2.0, "V_cut": 1e-7, "V_w": 0.1, "mu_w": 0.2}
CUT_OFF = {"V1": 1e-2, "V2": 0.5}
EVERY = [(name, form) for name, law in LAWS.items() for form in forms_of(law)]


def random_point(law, rng):
    """Return a random state, near rest and far from it if slip may reverse; kappa, eta0, p."""
    slider = SimpleNamespace(**SLIDER, **OWN, **CUT_OFF)
    p = tuple(map(float, law.coefficients(10.0 ** rng.uniform(-8, 0), slider)))
    v, psi = 3.0 * rng.normal(), 2.0 * rng.normal(size=len(law.states))
    if law.reverses:
        v = rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-12, 2)
        if abs(v) > 3.0:  # bring the speed back to an ordinary one
            psi += (abs(v) - law.barrier(psi, p)) / sum(law.evolution_effects(p))
    y = v + rng.normal(), v, *psi
    return tuple(map(float, y)), 10.0 ** rng.uniform(-2, 1), 10.0 ** rng.uniform(-4, 2), p


def motion(y, law, kappa, eta0, p):
    """Return dx/dT without the load point's speed, dv/dT and d psi/dT."""
    at = point_at(law, p, y)
    return at.in_v((-kappa * at.w, at.g * at.c_inverse / eta0, *at.f))


def slopes(function, y, along, h):
    """Return the derivative of a function of y in a direction, an array of mpf."""
    up, down = (tuple(a + s * h * b for a, b in zip(y, along, strict=True)) for s in (1, -1))
    return (np.array(function(up)) - np.array(function(down))) / (2 * h)


def jacobian(y, *system):
    """Return the derivatives of `motion`, by row and column."""
    unit = np.eye(len(y))
    columns = [slopes(lambda u: motion(u, *system), y, one, mp.mpf(1e-30)) for one in unit]
    return np.transpose(columns)


@pytest.mark.parametrize("damped", [False, True])
@pytest.mark.parametrize(("name", "form"), EVERY)
def test_derivatives(name, form, damped):
    """The error is at most 1e-12 of a row's largest term, for both signs and near rest."""
    law, rng = composed(LAWS[name], form, damped), np.random.default_rng(5)
    for _ in range(4):
        y, kappa, eta0, p = random_point(law, rng)
        z = tuple(map(float, rng.normal(size=len(y))))
        with mp.workdps(90):
            at, system = tuple(map(mp.mpf, y)), (law, kappa, eta0, p)
            exact = jacobian(at, *system)
            change = slopes(lambda u, system=system: jacobian(u, *system), at, z, mp.mpf(1e-22))
            traces = [float(np.trace(one)) for one in (exact, change)]
        at = point_at(law, p, y)
        how = {"z": z, "kappa": kappa, "q": at.c_inverse / eta0, "m": 1.0}
        directions = [at.in_omega(tuple(one)) for one in np.eye(len(y))]
        for matrix, true in (("jacobian", exact), ("curvature", change)):
            rows = at.derived(matrix, **how)
            if matrix == "jacobian":
                found = [trace_of(rows, at.omega_by_psi, 1.0)]
            for row, of_row in zip(rows, true.astype(float), strict=True):
                terms = np.array([[x * k[j] for j, x in row.items()] for k in directions])
                size = max(np.abs(terms).max(), np.abs(of_row).max())
                np.testing.assert_allclose(terms.sum(axis=1), of_row, rtol=0, atol=1e-12 * size)
        found.append(at.derived("change_of_trace", **how))
        for one, true, matrix in zip(found, traces, (exact, change), strict=True):
            size = np.abs(np.diag(matrix).astype(float)).max()
            assert one == pytest.approx(true, rel=0, abs=1e-12 * size)


def test_threads_get_the_same_equations():
    law = type(LAWS["two-state-aging"])()
    names = [*["curvature", "slaved_slopes", "f_slopes", "change_of_trace"] * 2]
    start, before = threading.Barrier(len(names)), sys.getswitchinterval()

    def make(name):
        start.wait()
        return law.motion, law.motion[name]

    sys.setswitchinterval(1e-6)
    try:
        with ThreadPoolExecutor(len(names)) as pool:
            made = list(pool.map(make, names))
    finally:
        sys.setswitchinterval(before)
    assert len({id(one) for one, _ in made}) == 1
    assert all(law.motion[name] is found for name, (_, found) in zip(names, made, strict=True))
