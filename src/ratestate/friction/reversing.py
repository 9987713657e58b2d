"""Slip that may reverse, where friction stays finite at rest (`forms/regularized.py`).

There the variable v is friction itself, and mu_ref is 0,

    v = mu/a,     w = V/V_ref = exp(v - Theta) - exp(-v - Theta) = c t,     t = tanh v,

with forward and backward jumps over barriers of the height Theta = mu0/a + sum_k beta_k psi_k,
but for V_ref instead of V0, and c = 2 cosh(v) exp(-Theta) the sum of all jumps.  All of it is
smooth at rest, and w keeps its digits however small friction is.
"""

from .expressions import LIMIT
from .functions import asinh_of, exp, larger, log, smaller, sqrt, tanh, where
from .kinematics import Forward
from .tuples import dot, plus, product, times

# The smallest |w| that laws of state are given, and the least part of c that is taken for the
# fastest speed.
SMALLEST, LEAST = 1e-100, 1e-6


class Reversing(Forward):
    """Slip that may reverse, where v is mu/a; laws of state are given |V|.

    A law of this kind has `barrier`, and nothing but `evolution_effects` of each state.
    """

    reverses = True

    def barrier(self, psi, p):
        """Theta."""
        raise NotImplementedError

    def jump_exponents(self, v, psi, p):
        """`log_of_faster`, in a tuple."""
        return (self.log_of_faster(v, psi, p),)

    def net_speed(self, v, forward, inverse, jumps):
        """w, 1/c, and c in a tuple."""
        t = tanh(v)
        c = jumps[0] * (2.0 / (1.0 + abs(t)))
        return c * t, 1.0 / c, (c,)

    def speed_slope(self, w, e):
        """c, the sum of all jumps."""
        return e[0]

    def log_of_faster(self, v, psi, p):
        """ln of the rate of forward or of backward jumps, whichever is larger."""
        return abs(v) - self.barrier(psi, p)

    def order_of_speed(self, v, w):
        """w itself."""
        return w

    def v_of_order(self, number, psi, p):
        """v, at psi = 0, of this speed."""
        return self.v_at(number, (0.0,) * len(psi), p)

    def order_slope(self, w, psi, e, p):
        """The derivative of `v_of_order` by omega: the sum of all jumps over that at psi = 0."""
        rest = 2.0 * exp(-smaller(self.barrier((0.0,) * len(psi), p), LIMIT))
        size = larger(abs(w), rest)
        part = smaller(abs(w), rest) / size
        return self.speed_slope(w, e) / (size * sqrt(1.0 + part * part))

    def shares(self, w, c_inverse, p):
        """s_k of d omega = dv + sum_k s_k d psi_k, a tuple."""
        return times(-w * c_inverse, self.evolution_effects(p))

    def error_of_v(self, error, w_new, e_new, p, fastest):
        """Error in omega or, if friction hardly depends on the speed, in the speed.

        The latter as a part of the fastest speed of the run.
        """
        c = self.speed_slope(w_new, e_new)
        shares = self.shares(w_new, 1.0 / c, p)
        omega = abs(error[1] + dot(shares, error[2:]))
        largest = larger(larger(fastest[0], -fastest[1]), larger(abs(w_new), fastest[2]))
        return omega * larger(1.0, c / larger(largest, LEAST * c))

    def size(self, w):
        """|w|, but not so small that its logarithm is lost."""
        return larger(abs(w), SMALLEST)

    def own_exponents(self, v, w, psi, p):
        """The law's `exponents` at |V|."""
        size = self.size(w)
        return self.exponents(log(size), size, psi, p)

    def resistance_in_v(self, v, w, psi, p):
        """mu/a."""
        return v

    def resistance_slopes(self, v, w, psi, e, p):
        """Slopes of `resistance_in_v`: by omega and by each of psi, a tuple."""
        return 1.0, times(w / self.speed_slope(w, e), self.evolution_effects(p))

    def inertia_slopes(self, g, slopes, m, v, w, psi, e, p):
        """Slopes of -m dv/dT, with those of 1/c and of s_k: of t = w/c they are 1 - t^2 by v."""
        effects, t = self.evolution_effects(p), w / self.speed_slope(w, e)
        evolution = m * dot(effects, self.rates_in_v(v, w, psi, e, p))
        bend = (1.0 - t) * (1.0 + t)
        by_omega, by_psi = slopes
        drop = times(-bend * (g + evolution * t), effects)
        return by_omega + g * t - evolution * bend, plus(by_psi, drop)

    def state_rates(self, v, w, psi, e, p):
        """The law's `rates` at |V|."""
        size = self.size(w)
        return self.rates(log(size), size, psi, e[1:], p)

    def state_rate_slopes(self, v, w, psi, e, p):
        """Slopes of `state_rates`: by omega, a tuple, and each by its own state, a tuple."""
        size = self.size(w)
        by_log, by_psi = self.rate_partials(log(size), size, psi, e[1:], p)
        return times(self.log_slope(w, e), by_log), by_psi

    def log_slope(self, w, e):
        """d ln |w|/d omega."""
        c = self.speed_slope(w, e)
        return where(w > 0.0, c, -c) / self.size(w)

    def rates_bent(self, w, psi, e, p, one, other, bend_of_w):
        """Second derivatives of `state_rates` in two directions.

        one, other : d omega and d psi of each; bend_of_w : of w the second derivative, over c
        """
        size, slope = self.size(w), self.log_slope(w, e)
        log_size = log(size)
        by_log, _ = self.rate_partials(log_size, size, psi, e[1:], p)
        log_log, log_psi, psi_psi = self.rate_partials_2(log_size, size, psi, e[1:], p)
        first, second = slope * one[0], slope * other[0]
        bent = times(slope * bend_of_w - first * second, by_log)
        bent = plus(bent, times(first * second, log_log))
        mixed = plus(times(first, other[1]), times(second, one[1]))
        bent = plus(bent, product(log_psi, mixed))
        return plus(bent, product(psi_psi, product(one[1], other[1])))

    def decay_slopes(self, w, psi, e, p):
        """Slopes of the derivative of each rate by its own state: by omega, and by that state."""
        size = self.size(w)
        _, log_psi, psi_psi = self.rate_partials_2(log(size), size, psi, e[1:], p)
        return times(self.log_slope(w, e), log_psi), psi_psi

    def v_at(self, w, psi, p):
        """v at the speed w, of arrays too."""
        return asinh_of(w, self.barrier(psi, p))

    def speed(self, v, psi, p):
        """w, but where the engine's saturates far up."""
        import numpy as np

        with np.errstate(over="ignore"):
            jumps = np.exp(np.maximum(self.log_of_faster(v, psi, p), -LIMIT))
        return self.net_speed(v, jumps, jumps, (jumps,))[0]
