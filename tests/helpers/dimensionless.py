"""Sliders by kappa, beta and eta; their equations as published."""

import numpy as np

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
    assert first.came_back.all()
    return system, state(system, first.image)


def rates(law, kappa, beta, eta):
    """dy/dT as published, for real and complex y = (x, v, psi)."""

    def f(y):
        x, v, psi = y
        evolution = -np.exp(v) * (v + psi) if law == "slip" else np.exp(-psi) - np.exp(v)
        return np.array(
            [kappa * (1 - np.exp(v)), (x - v - beta * psi) / (eta * np.exp(v)), evolution]
        )

    return f


def jacobian(law, kappa, beta, eta):
    def J(y):
        x, v, psi = y
        w = np.exp(v)
        push = (x - v - beta * psi) / (eta * w)
        by_v, by_psi = (-w * (1 + v + psi), -w) if law == "slip" else (-w, -np.exp(-psi))
        inertial = [1 / (eta * w), -1 / (eta * w) - push, -beta / (eta * w)]
        return np.array([[0, -kappa * w, 0], inertial, [0, by_v, by_psi]])

    return J
