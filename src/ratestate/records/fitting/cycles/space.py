"""Coordinates in which cycles are fitted: logarithms, and a distance from steady sliding.

The amplitude of a cycle follows from how far below K_c the spring's stiffness is, and near K_c it
changes hundredfold where parameters change by a few percent.  So b, or else a, moves as

    ln(K_c/K - STRIP)

at the record's lowest speed: this coordinate changes the amplitude, the others change the shape of
the cycle, and least squares need not follow a curved valley.
"""

import numpy as np

from ....friction.stability import K_c, a_of_K_c, b_of_K_c
from ...messages import fitting as sentences
from ..unknowns import checked_free, of_slider, parameter

# Largest distance of a coordinate from its start: a run that gets there does not converge.
FAR = 12.0
# K_c/K below which no cycle exists: some coexist with steady sliding, a little above K_c.
STRIP = 0.98
# Step of a central difference in a coordinate.
STEP = 1e-5
# Ranges from which starts are drawn.
DIRECT = (3e-4, 0.03)  # a
WEAKER = (0.01, 20.0)  # K_c/K - STRIP
SLIPS = (2.0, 200.0)  # slip in a cycle, over Dc
STIFFER = (0.9, 60.0)  # K over amplitude sigma/(V_lp period), that of a sawtooth
LIGHTER = (1e-10, 1.0)  # (natural period/period)^2
NEAR = 1.1  # half width of the range about the slider's own values, as a logarithm


class Space:
    """The free parameters of a slider as coordinates (n, k), and back; V_lp is the lowest speed.

    ParameterError for what cannot be free or has no part in cycles, and for a slider without
    cycles: M = 0, K = inf, or b <= a where both are given.
    """

    def __init__(self, slider, free, V_lp):
        self.names = checked_free(free, [slider])
        for name in self.names:
            if what := parameter(name).no_part_in_cycles:
                raise sentences.refusal("cycles.no_part", name=name, what=what)
        symbols = of_slider(slider.friction_law)
        self.fixed = {symbol: float(getattr(slider, symbol)) for symbol in symbols}
        if self.fixed["M"] == 0.0:
            raise sentences.refusal("cycles.massless")
        if np.isinf(self.fixed["K"]):
            raise sentences.refusal("cycles.rigid")
        if not {"a", "b"} & set(self.names) and self.fixed["b"] <= self.fixed["a"]:
            raise sentences.refusal("cycles.strengthening", a=self.fixed["a"], b=self.fixed["b"])
        self.V_lp, self.sigma = V_lp, float(slider.sigma)
        # the parameter in place of which the distance from steady sliding is a coordinate
        self.replaced = "b" if "b" in self.names else "a" if "a" in self.names else None

    # far from all sliders, where searches may try, values overflow: there is no cycle
    @np.errstate(over="ignore", divide="ignore", invalid="ignore")
    def values(self, q):
        """Symbol -> (n,) [SI] of all that the motion depends on at coordinates q (n, k)."""
        n = len(q)
        values = {symbol: np.full(n, value) for symbol, value in self.fixed.items()}
        values |= zip(self.names, np.exp(np.clip(q.T, -700.0, 700.0)), strict=True)
        if self.replaced:
            excess = values[self.replaced]  # K_c/K - STRIP
            rest = {s: values[s] for s in ("a", "b", "Dc", "M") if s != self.replaced}
            solve = b_of_K_c if self.replaced == "b" else a_of_K_c
            critical = (excess + STRIP) * values["K"]
            values[self.replaced] = solve(self.V_lp, critical, sigma=self.sigma, **rest)
        return values

    def coordinates(self, values):
        """(n, k) of values, symbol -> (n,), where b > a."""
        columns = {s: np.log(values[s]) for s in self.names if s != self.replaced}
        if self.replaced:
            of_K_c = {s: values[s] for s in ("a", "b", "Dc", "M")}
            ratio = K_c(self.V_lp, sigma=self.sigma, **of_K_c) / values["K"]
            columns[self.replaced] = np.log(np.maximum(ratio - STRIP, WEAKER[0]))
        return np.stack([columns[symbol] for symbol in self.names], axis=1)

    @property
    def reported(self):
        """Names that are reported: the free parameters, mu0, and a - b if a or b is free."""
        return (*self.names, "mu0", *(("a_minus_b",) if self.replaced else ()))

    def value(self, name, q):
        """(n,) a free parameter's logarithm, or a - b, at coordinates q (n, k)."""
        values = self.values(q)
        return values["a"] - values["b"] if name == "a_minus_b" else np.log(values[name])

    def gradient(self, name, q):
        """(k,) derivative of `value` by the coordinates (k,)."""
        step = STEP * np.eye(len(self.names))
        up, down = np.split(self.value(name, np.concatenate([q + step, q - step])), 2)
        return (up - down) / (2.0 * STEP)

    def own(self):
        """(1, k) coordinates of the slider's own values, moved to where cycles exist."""
        return self.coordinates({symbol: np.array([v]) for symbol, v in self.fixed.items()})

    def cloud(self, n, amplitude, period, V_lp, seed):
        """(n, k) points to start from: one half from the record's features, one about the slider.

        n : a power of 2
        """
        from scipy.stats import qmc

        k = len(self.names)
        points = qmc.Sobol(2 * k, rng=seed).random(n // 2)
        about = self.own() + NEAR * (2.0 * points[:, :k] - 1.0)
        parts = dict(zip(self.names, points[:, k:].T, strict=True))
        values = {symbol: np.full(n // 2, value) for symbol, value in self.fixed.items()}

        def within(symbol, low, high):
            return low * (high / low) ** parts[symbol]

        stiffness = amplitude * self.sigma / (V_lp * period)
        a = self.fixed["a"]
        if "Dc" in parts:
            values["Dc"] = V_lp * period / within("Dc", *SLIPS[::-1])
        if "K" in parts:
            values["K"] = stiffness * within("K", *STIFFER)
        if "M" in parts:
            natural = (period / (2.0 * np.pi)) ** 2
            values["M"] = values["K"] * natural * within("M", *LIGHTER)
        if "a" in parts:
            values["a"] = within("a", min(DIRECT[0], a / 3.0), max(DIRECT[1], 3.0 * a))
        q = self.coordinates(values)
        if self.replaced:
            q[:, self.names.index(self.replaced)] = np.log(within(self.replaced, *WEAKER))
        return np.concatenate([self.own(), about[1:], q])
