"""Sliders by kappa, beta and eta; their equations as published."""

import math

import numpy as np
from naive import Naive, top
from scipy.integrate import solve_ivp

from ratestate.dynamics.cycles.attractor import steady_start
from ratestate.dynamics.cycles.shooting import return_map
from ratestate.dynamics.cycles.system import one_length_system, state

#: kappa, beta, eta of cycles in numerics.md
P1 = P4A = (1.5, 2.0, 0.512)
P2 = P4B = (0.48, 1.6, 5e-8)


def make_system(law, kappa, beta, eta, v_limit=np.inf):
    values = np.broadcast_arrays([0.0], kappa, beta, eta, v_limit)[1:]
    return one_length_system(law, *(np.array(v, float) for v in values))


def random_sliders(law, n, eta=None, seed=5):
    """Sliders of every kind, all with cycles, and points of the section on their way there."""
    rng = np.random.default_rng(seed)
    beta = 1 + 10 ** rng.uniform(-0.7, 0.7, n)
    eta = 10 ** rng.uniform(-20, 4, n) if eta is None else np.full(n, eta)
    softness = 10 ** rng.uniform(-4, -0.2, n)
    system = make_system(law, (1 - softness) * (beta - 1), beta, eta)
    first = return_map(system, steady_start(system), 1e-6)
    assert first.has_returned.all()
    return system, state(system, first.image)


def twin(law, kappa, beta, eta):
    """The slider in dimensionless variables as a `Naive`, with units of 1."""
    return Naive(a=1.0, b=beta, Dc=1.0, sigma=1.0, K=kappa, M=eta, mu0=0.0, V0=1.0, law=law)


def rates(*slider):
    """dy/dT of y = (x, v, psi)."""
    case = twin(*slider)
    return lambda y: np.array(case.rates(0.0, y, lambda t: 1.0))


def jacobian(*slider):
    """Derivatives of `rates` by y."""
    case = twin(*slider)
    return lambda y: case.jacobian(0.0, y, lambda t: 1.0)


def measured_by_scipy(law, parameters, y, period, returns=1, method="Radau"):
    """Return the measures of a cycle from y on, by a dense run and an FFT; and its middle."""
    f, J = rates(law, *parameters), jacobian(law, *parameters)
    known = {"jac": lambda t, y: J(y)} if method == "Radau" else {}

    def sticks(t, y):
        return y[1] - math.log(0.1)

    tight = {"rtol": 1e-11, "atol": 1e-11, "max_step": period / (500 * returns)}
    run = solve_ivp(
        lambda t, y: f(y),
        (0, period),
        y,
        method,
        **(tight | known),
        events=sticks,
        dense_output=True,
    )
    assert np.abs(run.y[:, -1] - y).max() < 1e-6
    t = (run.t[:-1, None] + np.diff(run.t)[:, None] * np.linspace(0, 1, 21)[:-1]).ravel()
    x, v, psi = run.sol(t)
    down, up = run.t_events[0][::2], run.t_events[0][1::2]
    n = 1 << 16
    stress = run.sol(period * np.arange(n) / n)[0]
    share = 2 * np.abs(np.fft.rfft(stress)[returns] / n) ** 2 / stress.var()
    return {
        "v_max": top(v),
        "v_min": -top(-v),
        "amplitude": top(x) + top(-x),
        "g_max": top(np.abs(x - v - parameters[1] * psi)),
        "slow_fraction": (up - down).sum() / period,
        "fundamental": share,
    }, run.sol(0.5 * period)
