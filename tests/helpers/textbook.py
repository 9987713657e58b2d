"""A plain-Python twin of the friction laws, as their papers write them, sharing no code with ours.

The state is y = (tau/sigma, ln V, ln theta, ...) in SI, and SciPy takes it from there:

    d tau/dt = K (V_lp - V)      M dV/dt = tau - sigma s mu - damping V    mu, d theta/dt: as below.

s = sigma(t)/sigma is 1 unless the parameters have it, and alpha.
"""

import math

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

#: name -> parameters beside the common ones, of which tests draw others
OF_LAW = {
    "slip": {},
    "aging": {},
    "two-state-slip": {"b2": 0.001, "Dc2": 5e-5},
    "two-state-aging": {"b2": 0.001, "Dc2": 5e-5},
    "nagata": {"c": 1.0},
    "kato-tullis": {"V_cut": 1e-4},
    "prz": {},
    "flash-heating": {"V_w": 0.1, "mu_w": 0.2},
}


def drawn(law, rng):
    """Random parameters of a slider [SI], and its load-point speed, near the edge of stability."""
    a = 10 ** rng.uniform(-2.7, -1.7)
    p = {"a": a, "b": a * rng.uniform(1.1, 3.0), "Dc": 10 ** rng.uniform(-6, -4)}
    p |= {"sigma": 10 ** rng.uniform(5.5, 7.5), "mu0": 0.6, "V0": 1e-6}
    V = 10 ** rng.uniform(-6, -2)
    more = {
        "b2": p["b"] * rng.uniform(-0.3, 0.8),
        "Dc2": p["Dc"] * 10 ** rng.uniform(-1.0, 1.0),
        "c": rng.uniform(0.0, 2.0),
        "V_cut": V * 10 ** rng.uniform(-1.5, 1.5),
        "V_w": V * 10 ** rng.uniform(-0.5, 1.5),
        "mu_w": 0.6 * rng.uniform(0.1, 0.6),
    }
    p |= {symbol: more[symbol] for symbol in OF_LAW[law]}
    p["K"] = rng.uniform(0.4, 2.5) * p["b"] * p["sigma"] / p["Dc"]
    eta = 10 ** rng.uniform(-4, 1)
    p["M"] = eta * a * p["sigma"] * p["Dc"] / V**2
    return p, V


def drawn_of_form(law, rng, form, damped=False):
    """Draw parameters as `drawn` does, for a form of friction and perhaps with a dashpot."""
    p, V = drawn(law, rng)
    if form == "cut-off":
        p |= {"V1": V * 10 ** rng.uniform(-0.5, 3), "V2": V * 10 ** rng.uniform(0, 4)}
    elif form == "regularized" and law != "flash-heating":
        p |= {"mu0": p["a"] * rng.uniform(0.5, 20.0), "V0": V}
    p |= {"friction_form": form} if form != "log" else {}
    zeta = 10 ** rng.uniform(-2, 0.5)  # of the direct effect
    return p | ({"damping": zeta * p["a"] * p["sigma"] / V} if damped else {}), V


def wave(size, period):
    """s(t) = 1 + size sin(2 pi t/period), and d ln s/dt."""
    omega = 2.0 * math.pi / period

    def s(t):
        s = 1.0 + size * math.sin(omega * t)
        return s, size * omega * math.cos(omega * t) / s

    return s


class Textbook:
    """A slider under a law, by name, with parameters p [SI]."""

    # LSODA takes a third of Radau's time, and fails here and there on what benchmarks draw
    method, tolerance = "LSODA", 1e-12

    def __init__(self, law, p):
        self.law, self.p = law, p
        self.b = [p["b"], p["b2"]] if "b2" in p else [p["b"]]
        self.D = [p["Dc"], p["Dc2"]] if "b2" in p else [p["Dc"]]

    @property
    def regularized(self):
        """Whether friction is an inverse hyperbolic sine."""
        return self.law == "flash-heating" or self.p.get("friction_form") == "regularized"

    def barrier(self, theta):
        """ln of 2 V0 over the speed at which friction is a asinh(1)."""
        parts = zip(self.b, theta, self.D, strict=True)
        return self.p["mu0"] / self.p["a"] + sum(
            b / self.p["a"] * math.log(self.p["V0"] * th / D) for b, th, D in parts
        )

    def mu(self, V, theta):
        p = self.p
        if self.regularized:
            log_of = math.log(max(abs(V), 5e-324) / p["V0"]) + self.barrier(theta)
            size = math.asinh(0.5 * math.exp(log_of)) if log_of < 600.0 else log_of
            return p["a"] * math.copysign(size, V)
        if "V1" in p:  # cut-offs
            state = sum(
                b * math.log1p(p["V2"] * th / D)
                for b, th, D in zip(self.b, theta, self.D, strict=True)
            )
            return p["mu0"] - p["a"] * math.log1p(p["V1"] / V) + state
        state = sum(
            b * math.log(p["V0"] * th / D) for b, th, D in zip(self.b, theta, self.D, strict=True)
        )
        return p["mu0"] + p["a"] * math.log(V / p["V0"]) + state

    def steady_theta(self, V):
        """States in steady sliding."""
        if self.law == "kato-tullis":  # exp(-V/V_cut) = W ln W, W = V theta/Dc
            healing = math.exp(-V / self.p["V_cut"])
            W = brentq(lambda W: W * math.log(W) - healing, 1.0, 2.0, xtol=1e-15)
            return [W * self.D[0] / V]
        if self.law == "flash-heating":
            m = self.steady_mu(V) / self.p["a"]
            Psi = math.log(2.0 * self.p["V0"] / V) + m + math.log(-0.5 * math.expm1(-2.0 * m))
            Psi = (self.p["a"] * Psi - self.p["mu0"]) / self.p["b"]
            return [self.D[0] / self.p["V0"] * math.exp(Psi)]
        return [D / V for D in self.D]

    def steady_mu(self, V):
        """Steady friction under flash heating."""
        p = self.p
        slow = p["mu0"] - (p["b"] - p["a"]) * math.log(V / p["V0"])
        return p["mu_w"] + (slow - p["mu_w"]) / (1.0 + (V / p["V_w"]) ** 8) ** 0.125

    def steady(self, V):
        """y of steady sliding at V."""
        theta = self.steady_theta(V)
        stress = self.mu(V, theta) + self.p.get("damping", 0.0) * V / self.p["sigma"]
        return np.array([stress, self.variable(V), *map(math.log, theta)])

    def evolution(self, V, theta, dmu_dt):
        """d theta/dt of each state."""
        W = [V * th / D for th, D in zip(theta, self.D, strict=True)]
        if self.law in ("slip", "two-state-slip"):
            return [-x * math.log(x) for x in W]
        if self.law in ("aging", "two-state-aging"):
            return [1.0 - x for x in W]
        if self.law == "prz":
            return [0.5 * (1.0 - W[0] ** 2)]
        if self.law == "kato-tullis":
            return [math.exp(-V / self.p["V_cut"]) - W[0] * math.log(W[0])]
        if self.law == "flash-heating":
            return [theta[0] * V / self.D[0] * math.log(self.steady_theta(V)[0] / theta[0])]
        assert self.law == "nagata"
        return [1.0 - W[0] - self.p["c"] / self.p["b"] * theta[0] * dmu_dt]

    def effects(self, V, theta):
        """d mu/d ln V, and d mu/d ln theta of each state."""
        p = self.p
        if self.regularized:
            t = math.tanh(self.mu(V, theta) / p["a"])
            return p["a"] * t, [b * t for b in self.b]
        if "V1" not in p:
            return p["a"], self.b
        grown = [p["V2"] * th / D for th, D in zip(theta, self.D, strict=True)]
        return p["a"] * p["V1"] / (V + p["V1"]), [
            b * x / (1 + x) for b, x in zip(self.b, grown, strict=True)
        ]

    def variable(self, V):
        """That of y which is for V."""
        return math.log(V)

    def velocity(self, stress, theta, s=1.0):
        """V where friction and damping balance the spring, for M = 0."""
        damping = self.p.get("damping", 0.0) / self.p["sigma"]
        if self.regularized:
            return self.reversing_velocity(stress, theta, s)
        if "V1" in self.p:
            return math.exp(
                brentq(
                    lambda lnV: (
                        s * self.mu(math.exp(lnV), theta) + damping * math.exp(lnV) - stress
                    ),
                    -150.0,
                    20.0,
                    xtol=1e-14,
                    rtol=1e-15,
                )
            )
        without = self.mu(self.p["V0"], theta)
        free = self.p["V0"] * math.exp(min((stress / s - without) / self.p["a"], 600.0))
        if damping == 0.0:
            return free

        def off(lnV):
            return s * self.mu(math.exp(lnV), theta) + damping * math.exp(lnV) - stress

        # (with damping it is slower)
        low = min(math.log(free), math.log(self.p["a"] / damping)) - 700.0 * self.p["a"] - 50.0
        return math.exp(brentq(off, low, math.log(free) + 1e-9, xtol=1e-14, rtol=1e-15))

    def reversing_velocity(self, stress, theta, s):
        """As `velocity`, by friction that is finite at rest, of either sign."""
        p, rest = self.p, 2.0 * self.p["V0"] * math.exp(-self.barrier(theta))
        damping = p.get("damping", 0.0) * rest / p["sigma"]
        q = stress / s / p["a"]
        if damping > 0.0:

            def off(q):
                return s * p["a"] * q + damping * math.sinh(min(q, 700.0)) - stress

            q = brentq(off, min(q, 0.0) - 1e-9, max(q, 0.0) + 1e-9, xtol=1e-15)
        return rest * math.sinh(q)

    def rates(self, y, V_lp, t=0.0):
        p, theta = self.p, [math.exp(x) for x in y[2:]]
        s, d_lns = p["s"](t) if "s" in p else (1.0, 0.0)  # sigma(t)/sigma, d ln s/dt
        V = math.exp(y[1]) if p["M"] > 0 else self.velocity(y[0], theta, s)
        dashpot, mu = p.get("damping", 0.0) * V / p["sigma"], self.mu(V, theta)
        d_stress = p["K"] * (V_lp - V) / p["sigma"]
        # as if mu were constant: by the law of nagata d theta/dt holds d mu/dt too, solved for here
        c = p["c"] if self.law == "nagata" else 0.0
        by_s = [p.get("alpha", 0.0) / p["b"] * d_lns, *[0.0] * (len(theta) - 1)]
        still = self.evolution(V, theta, mu * d_lns)
        still = [d - th * by for d, th, by in zip(still, theta, by_s, strict=True)]
        direct, effects = self.effects(V, theta)
        state = sum(b * d / th for b, d, th in zip(effects, still, theta, strict=True))
        if p["M"] > 0:
            d_lnV = (p["sigma"] * (y[0] - s * mu - dashpot)) / (p["M"] * V)
        else:  # the spring's stress is that of friction and the dashpot
            push = d_stress - s * d_lns * mu
            d_lnV = ((1.0 + c) * push - s * state) / (s * direct + (1.0 + c) * dashpot)
        d_mu = (direct * d_lnV + state) / (1.0 + c)
        d_theta = self.evolution(V, theta, d_mu + mu * d_lns)
        d_log = [d / th - by for d, th, by in zip(d_theta, theta, by_s, strict=True)]
        return np.array([d_stress, d_lnV, *d_log])

    def sizes(self, y):
        """Of each variable, how much of it changes the motion."""
        return np.array([self.p["a"], *np.ones(len(y) - 1)])

    def tolerances(self, y, V_lp, tol):
        """Absolute errors allowed in each variable, from a start at y."""
        return tol * self.sizes(y)

    def jacobian(self, y, V_lp, t=0.0):
        """By central differences."""
        columns = []
        for h in np.diag(1e-6 * self.sizes(y)):
            change = self.rates(y + h, V_lp, t) - self.rates(y - h, V_lp, t)
            columns.append(change / (2 * h.sum()))
        return np.array(columns).T

    def differs(self, run, exact):
        """Largest difference of a run from y, in tau/(a sigma), ln V, ln theta and mu/a."""
        mu = [self.mu(math.exp(y[1]), [math.exp(x) for x in y[2:]]) for y in exact]
        found = [run.tau.values / self.p["sigma"] / self.p["a"], np.log(run.V.values)]
        found += [np.log(run[name].values) for name in ("theta", "theta2") if name in run]
        found += [run.mu.values / self.p["a"]]
        wanted = [exact[:, 0] / self.p["a"], *exact[:, 1:].T, np.array(mu) / self.p["a"]]
        return max(np.abs(x - y).max() for x, y in zip(found, wanted, strict=True))

    def solve(self, y, V_lp, times, start=0.0):
        """y at the times, one a row, under a constant V_lp from y at the start on."""
        inside = np.nextafter(start, np.inf), np.nextafter(times[-1], 0.0)  # of what s is there
        run = solve_ivp(
            lambda t, y: self.rates(y, V_lp, min(max(t, inside[0]), inside[1])),
            (start, times[-1]),
            y,
            self.method,
            times,
            jac=lambda t, y: self.jacobian(y, V_lp, min(max(t, inside[0]), inside[1])),
            rtol=self.tolerance,
            atol=self.tolerances(y, V_lp, self.tolerance),
        )
        assert run.success, run.message
        return run.y.T

    def through(self, y, V_lp, times, breaks):
        """As `solve`, where s has kinks or jumps at these times, none of which is in `times`."""
        rows, start = [], 0.0
        for end in [*breaks, times[-1]]:
            here = [t for t in times if start <= t <= end] if end == times[-1] else []
            here = here or [t for t in times if start <= t < end]
            found = self.solve(y, V_lp, [*here, end] if end not in here else here, start=start)
            rows += list(found[: len(here)])
            y, start = found[-1], end
            if end < times[-1]:
                y = self.jumped(y, *(self.p["s"](np.nextafter(end, x))[0] for x in (0.0, np.inf)))
        rows = np.array(rows)
        if self.p["M"] == 0.0:  # friction and the dashpot balance the spring
            for t, row in zip(times, rows, strict=True):
                s = self.p["s"](t)[0] if "s" in self.p else 1.0
                row[1] = self.variable(self.velocity(row[0], np.exp(row[2:]), s))
        return rows

    def jumped(self, y, before, after):
        """y where s jumps."""
        y, p, rise = y.copy(), self.p, math.log(after / before)
        alpha, c = p.get("alpha", 0.0), p["c"] if self.law == "nagata" else 0.0
        if c == 0.0:
            y[2] -= alpha / p["b"] * rise
            return y
        # V stays: mu + alpha/c falls in proportion; without mass it then goes where friction
        # balances, and theta with it as c d mu/b
        theta = np.exp(y[2:])
        V = math.exp(y[1]) if p["M"] > 0 else self.velocity(y[0], theta, before)
        mu = self.mu(V, theta) + alpha / c
        y[2] += mu * math.expm1(-c / (1.0 + c) * rise) / p["b"]
        if p["M"] == 0.0:
            taken = c / (1.0 + c) * p["a"] / p["b"]

            def off(change):
                theta, speed = math.exp(y[2] - taken * change), V * math.exp(change)
                dashpot = p.get("damping", 0.0) * speed / p["sigma"]
                return after * self.mu(speed, [theta]) + dashpot - y[0]

            y[2] -= taken * brentq(off, -300.0, 300.0, xtol=1e-14)
        return y


class Reversing(Textbook):
    """Friction by an inverse hyperbolic sine with V itself as a variable, which may be < 0."""

    regularized = True

    def variable(self, V):
        return V

    def evolution(self, V, theta, dmu_dt):
        if V == 0.0:  # slip does nothing then, and healing all it can
            return [0.0 if "slip" in self.law or self.law == "flash-heating" else 1.0] * len(theta)
        return super().evolution(V, theta, dmu_dt)

    def rates(self, y, V_lp, t=0.0):
        p, theta = self.p, [math.exp(x) for x in y[2:]]
        s, d_lns = p["s"](t) if "s" in p else (1.0, 0.0)
        V = y[1] if p["M"] > 0 else self.velocity(y[0], theta, s)
        d_V = 0.0
        if p["M"] > 0:
            force = p["sigma"] * (y[0] - s * self.mu(V, theta)) - p.get("damping", 0.0) * V
            d_V = force / p["M"]
        d_theta = self.evolution(abs(V), theta, 0.0)
        by_s = [p.get("alpha", 0.0) / p["b"] * d_lns, *[0.0] * (len(theta) - 1)]
        d_log = [d / th - by for d, th, by in zip(d_theta, theta, by_s, strict=True)]
        return np.array([p["K"] * (V_lp - V) / p["sigma"], d_V, *d_log])

    def sizes(self, y):
        rest = 2.0 * self.p["V0"] * math.exp(-self.barrier([math.exp(x) for x in y[2:]]))
        return np.array([self.p["a"], math.hypot(y[1], rest), *np.ones(len(y) - 2)])

    def tolerances(self, y, V_lp, tol):
        return 1e-3 * tol * np.array([self.p["a"], max(abs(y[1]), V_lp), *np.ones(len(y) - 2)])

    def differs(self, run, exact):
        """Largest difference of a run from y: tau/(a sigma), V over the largest, ln theta, mu/a."""
        V, theta = exact[:, 1], np.exp(exact[:, 2:])
        mu = np.array([self.mu(v, th) for v, th in zip(V, theta, strict=True)])
        names = [name for name in ("theta", "theta2") if name in run]
        off = [run.tau.values / self.p["sigma"] - exact[:, 0], run.mu.values - mu]
        off = [x / self.p["a"] for x in off] + [(run.V.values - V) / np.abs(V).max()]
        off += [np.log(run[name].values) - x for name, x in zip(names, exact.T[2:], strict=True)]
        return max(np.abs(x).max() for x in off)
