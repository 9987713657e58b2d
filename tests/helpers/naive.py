"""A plain-Python twin of the engine: slow, obvious, sharing no code with the package.

It works in physical variables and seconds, y = (tau/sigma, ln V, ln theta), where the engine works
in dimensionless ones, and is solved by SciPy's Radau.  Only the equations are the same:

    d tau/dt = K (V_lp - V)      M dV/dt = tau - sigma mu      mu, d theta/dt: eqs 1-3.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

# The paper's, of its Fig. 2
FIG2 = {
    "a": 0.003,
    "b": 0.006,
    "Dc": 1e-5,
    "mu0": 0.6,
    "V0": 1e-9,
    "sigma": 2e6,
    "M": 3e3,
    "K": 9e8,
}


class Naive(NamedTuple):
    """Parameters in SI, as of SpringSlider, with finite K."""

    a: float
    b: float
    Dc: float
    sigma: float
    K: float
    M: float = 0.0
    mu0: float = 0.6
    V0: float = 1e-6
    law: str = "slip"

    def mu(self, V, theta):
        return (
            self.mu0 + self.a * math.log(V / self.V0) + self.b * math.log(self.V0 * theta / self.Dc)
        )

    def steady(self, V):
        """(tau/sigma, ln V, ln theta) of steady sliding at V."""
        return (
            self.mu0 + (self.a - self.b) * math.log(V / self.V0),
            math.log(V),
            math.log(self.Dc / V),
        )

    def log_velocity(self, stress, log_theta):
        """ln V where friction balances the spring (M = 0)."""
        state = self.b * (math.log(self.V0 / self.Dc) + log_theta)
        return math.log(self.V0) + (stress - self.mu0 - state) / self.a

    def state_rate(self, log_v, log_theta):
        """d ln theta/dt."""
        V = math.exp(log_v)
        if self.law == "aging":
            return math.exp(-log_theta) - V / self.Dc
        return -V / self.Dc * (log_v + log_theta - math.log(self.Dc))

    def rates(self, t, y, V_lp):
        """dy/dt of three variables (M > 0) or of two, (tau/sigma, ln theta) (M = 0)."""
        if self.M == 0:
            stress, log_theta = y
            log_v = self.log_velocity(stress, log_theta)
            return [
                self.K * (V_lp(t) - math.exp(log_v)) / self.sigma,
                self.state_rate(log_v, log_theta),
            ]
        stress, log_v, log_theta = y
        V = math.exp(log_v)
        friction = (
            self.mu0
            + self.a * (log_v - math.log(self.V0))
            + self.b * (math.log(self.V0 / self.Dc) + log_theta)
        )
        return [
            self.K * (V_lp(t) - V) / self.sigma,
            self.sigma * (stress - friction) / (self.M * V),
            self.state_rate(log_v, log_theta),
        ]

    def jacobian(self, t, y, V_lp):
        a, b, Dc = self.a, self.b, self.Dc
        log_v = self.log_velocity(*y) if self.M == 0 else y[1]
        V, log_theta = math.exp(log_v), y[-1]
        if self.law == "aging":
            by_v, by_theta = -V / Dc, -math.exp(-log_theta)
        else:
            by_v = -V / Dc * (1.0 + log_v + log_theta - math.log(Dc))
            by_theta = -V / Dc
        spring = -self.K * V / self.sigma
        if self.M == 0:
            return np.array([[spring / a, -spring * b / a], [by_v / a, by_theta - by_v * b / a]])
        c = self.sigma / (self.M * V)
        push = self.rates(t, y, V_lp)[1]
        return np.array([[0.0, spring, 0.0], [c, -c * a - push, -c * b], [0.0, by_v, by_theta]])

    def solve(self, y, t0, t1, V_lp, tol=1e-12, events=None, method="Radau", dense=False):
        """`solve_ivp` from y at t0 to t1 under a smooth V_lp(t) (float or function)."""
        speed = V_lp if callable(V_lp) else lambda t: V_lp
        scale = np.array([self.a, 1.0, 1.0]) if self.M > 0 else np.array([self.a, 1.0])
        known = {"jac": lambda t, y: self.jacobian(t, y, speed)} if method == "Radau" else {}
        # relative accuracy of ln V = -30 would be another thing than what the engine controls
        found = solve_ivp(
            lambda t, y: self.rates(t, y, speed),
            (t0, t1),
            y,
            method=method,
            rtol=max(tol / 30, 2.3e-14),
            atol=tol * scale,
            events=events,
            dense_output=dense,
            **known,
        )
        assert found.success, found.message
        return found


def march(case, y, segments, t_end, tol=1e-12, method="Radau"):
    """State at t_end, landing on every break.

    y : (tau/sigma, ln V, ln theta) at t = 0, also where M = 0
    segments : (start [s], V_lp there [m/s], acceleration [m/s^2]), the first from t = 0
    """
    y = np.array([y[0], y[2]] if case.M == 0 else y, float)
    for k, (start, V, rate) in enumerate(segments):
        end = min(segments[k + 1][0] if k + 1 < len(segments) else math.inf, t_end)
        if end > start:

            def speed(t, start=start, V=V, rate=rate):
                return V + rate * (t - start)

            y = case.solve(y, start, end, speed, tol, method=method).y[:, -1]
    if case.M == 0:
        return np.array([y[0], case.log_velocity(*y), y[1]])
    return y


class Cycle(NamedTuple):
    """One return from the section V = V_lp, V rising, to itself."""

    end: np.ndarray  # (tau/sigma, ln theta) there
    period: float
    amplitude: float  # of tau/sigma
    V_max: float
    V_min: float
    inertia: float  # largest |tau/sigma - mu| over the amplitude
    residual: float = math.nan  # distance of the end from the start


def one_cycle(case, stress, log_theta, V_lp, t_max, tol=1e-12, method="Radau"):
    """The return that begins at this point of the section."""
    log_v = math.log(V_lp)

    def up(t, y):
        return y[1] - log_v

    def down(t, y):
        return y[1] - log_v

    up.direction, down.direction, up.terminal = 1.0, -1.0, 1
    # Leave the section first: an event at the very start may count as a crossing.
    y = [stress, log_v, log_theta]
    first = case.solve(y, 0.0, 1e-3 * t_max, V_lp, tol, method=method, dense=True)
    rest = case.solve(first.y[:, -1], first.t[-1], t_max, V_lp, tol, (up, down), method, True)
    fractions = np.linspace(0.0, 1.0, 21)[:-1]
    states = []
    for leg in (first, rest):
        t = (leg.t[:-1, None] + np.diff(leg.t)[:, None] * fractions).ravel()
        states.append(leg.sol(t))
    x, v, s = np.concatenate(states, axis=1)
    friction = case.mu0 + case.a * (v - math.log(case.V0))
    friction += case.b * (math.log(case.V0 / case.Dc) + s)
    end, low = rest.y_events[0][0], rest.y_events[1][-1][0]
    amplitude = end[0] - low
    return Cycle(
        end[[0, 2]],
        rest.t_events[0][0],
        amplitude,
        math.exp(top(v)),
        math.exp(-top(-v)),
        top(np.abs(x - friction)) / amplitude,
    )


def top(values):
    """Largest value, on the parabola through it and its neighbours."""
    i = int(np.argmax(values))
    if not 0 < i < len(values) - 1:
        return float(values[i])
    a, b, c = values[i - 1 : i + 2]
    return float(b + (a - c) ** 2 / (8.0 * (2.0 * b - a - c)))


def limit_cycle(case, stress, log_theta, V_lp, t_max, tol=1e-12, method="Radau", newtons=3):
    """The limit cycle through about this point of V = V_lp: Newton on the return map."""
    u = np.array([stress, log_theta])
    for _ in range(newtons):
        end = one_cycle(case, *u, V_lp, t_max, tol, method).end
        jacobian = np.empty((2, 2))
        for i, d in enumerate((1e-5 * case.a, 1e-5)):
            moved = u.copy()
            moved[i] += d
            jacobian[:, i] = (one_cycle(case, *moved, V_lp, t_max, tol, method).end - end) / d
        u = u + np.linalg.solve(np.eye(2) - jacobian, end - u)
    cycle = one_cycle(case, *u, V_lp, t_max, tol, method)
    return cycle._replace(residual=np.abs(cycle.end - u).max())
