"""Coordinates in which cycles are fitted: logarithms, and a distance from steady sliding.

The amplitude of a cycle follows from how far below K_c the spring's stiffness is, and near K_c it
changes hundredfold where parameters change by percents.  So b, or else a, moves as

    ln(K_c/K - STRIP)

at the record's lowest speed: what changes the amplitude is one coordinate, the others turn the
shape of the cycle, and least squares need not follow a bent valley.
"""

import numpy as np

from ...errors import ParameterError
from ...stability import K_c

PARAMETERS = ("a", "b", "Dc", "K", "M")
# How far a parameter may move from any start, as a logarithm: a run that gets there has gone off.
FAR = 12.0
# K_c/K at which cycles surely end: some live on beside steady sliding, a little above K_c.
STRIP = 0.98
# Ranges from which starts are drawn, where a record does not say more.
DIRECT = (3e-4, 0.03)  # a
WEAKER = (0.01, 20.0)  # K_c/K - STRIP
SLIPS = (2.0, 200.0)  # slip in a cycle, over Dc
STIFFER = (0.9, 60.0)  # K over amplitude sigma/(V_lp period), that of a sawtooth
LIGHTER = (1e-10, 1.0)  # (natural period/period)^2
NEAR = 1.1  # and about the slider's own values, as a logarithm


class Space:
    """The free parameters of a slider as coordinates (n, k), and back.

    Parameters
    ----------
    slider : SpringSlider
    free : sequence of str
    V_lp : float, the lowest speed [m/s]

    Raises
    ------
    ParameterError
        An unknown or repeated name; M = 0 or K = inf; b <= a where both are fixed.
    """

    def __init__(self, slider, free, V_lp):
        names = (free,) if isinstance(free, str) else tuple(free)
        names = tuple(name for name in names if name != "mu0")  # which every fit finds
        if not names or len(set(names)) < len(names) or not set(names) <= set(PARAMETERS):
            raise ParameterError(
                f"free = {free!r} must name some of {', '.join(PARAMETERS)}, each once"
            )
        self.names = tuple(symbol for symbol in PARAMETERS if symbol in names)
        self.fixed = {symbol: float(getattr(slider, symbol)) for symbol in PARAMETERS}
        if self.fixed["M"] == 0.0:
            raise ParameterError(
                "M = 0 kg/m^2: a slider without mass has no limit cycle; give M > 0, at least a "
                "guess, and free it where it is not known"
            )
        if np.isinf(self.fixed["K"]):
            raise ParameterError(
                "K = inf: a rigid machine does not oscillate; give a finite K [Pa/m], at least a "
                "guess, and free it where it is not known"
            )
        if not {"a", "b"} & set(self.names) and self.fixed["b"] <= self.fixed["a"]:
            raise ParameterError(
                f"b = {self.fixed['b']:g} <= a = {self.fixed['a']:g}: such a slider has no cycle; "
                f"free b, or give one that is larger than a"
            )
        self.V_lp, self.sigma = V_lp, float(slider.sigma)
        # whose place the distance from steady sliding takes
        self.weaker = "b" if "b" in self.names else "a" if "a" in self.names else None

    @property
    def size(self):
        return len(self.names)

    def values(self, q):
        """Symbol -> (n,) of all of `PARAMETERS` at coordinates q (n, k)."""
        n = len(q)
        values = {symbol: np.full(n, value) for symbol, value in self.fixed.items()}
        moved = dict(zip(self.names, np.exp(np.clip(q.T, -700.0, 700.0)), strict=True))
        over = moved.pop(self.weaker) if self.weaker else None
        values |= moved
        if self.weaker:
            self._weaken(values, over)
        return values

    def _weaken(self, values, over):
        """Set b, or a, so that K_c/K - STRIP is this."""
        # K_c = (b - a) sigma/Dc (1 + heavy/a)
        heavy = values["M"] * self.V_lp**2 / (self.sigma * values["Dc"])
        rise = (over + STRIP) * values["K"] * values["Dc"] / self.sigma
        if self.weaker == "b":
            values["b"] = values["a"] + rise / (1.0 + heavy / values["a"])
        else:
            half = 0.5 * (values["b"] - heavy - rise)
            root = np.hypot(half, np.sqrt(values["b"] * heavy))
            # the positive root, of two forms the one in which nothing cancels
            with np.errstate(divide="ignore"):
                other = values["b"] * heavy / np.maximum(root - half, 1e-300)
            values["a"] = np.where(half > 0.0, half + root, other)

    def coordinates(self, values):
        """(n, k) of values, symbol -> (n,), where b > a."""
        columns = {s: np.log(values[s]) for s in self.names if s != self.weaker}
        if self.weaker:
            a, b, Dc, K, M = (values[symbol] for symbol in PARAMETERS)
            stiffness = K_c(self.V_lp, a=a, b=b, Dc=Dc, sigma=self.sigma, M=M)
            columns[self.weaker] = np.log(np.maximum(stiffness / K - STRIP, WEAKER[0]))
        return np.stack([columns[symbol] for symbol in self.names], axis=1)

    def to_logarithms(self, q):
        """(k, k) derivative of the logarithms of the free parameters by the coordinates (k,)."""
        step = 1e-5 * np.eye(self.size)
        values = self.values(np.concatenate([q + step, q - step]))
        up, down = np.split(np.log([values[symbol] for symbol in self.names]), 2, axis=1)
        return (up - down) / 2e-5

    def own(self):
        """(1, k) the slider's own values, or, where those have no cycle, ones near to them."""
        return self.coordinates({symbol: np.array([v]) for symbol, v in self.fixed.items()})

    def cloud(self, n, amplitude, period, V_lp, sigma, seed):
        """(n, k) points to start from; one half about what a record says, one about the slider.

        n : a power of 2
        """
        from scipy.stats import qmc

        points = qmc.Sobol(2 * self.size, rng=seed).random(n // 2)
        about = self.own() + NEAR * (2.0 * points[:, : self.size] - 1.0)
        parts = dict(zip(self.names, points[:, self.size :].T, strict=True))
        values = {symbol: np.full(n // 2, value) for symbol, value in self.fixed.items()}

        def within(symbol, low, high):
            return low * (high / low) ** parts[symbol]

        stiffness = amplitude * sigma / (V_lp * period)
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
        if self.weaker:
            q[:, self.names.index(self.weaker)] = np.log(within(self.weaker, *WEAKER))
        return np.concatenate([self.own(), about[1:], q])
