"""How fast a slider slips, from the variables x, v and psi that the engine integrates.

Under most laws V = V_ref exp(v), which is never 0 nor negative.  Friction that stays finite at rest
(`forms/regularized.py`) lets slip reverse.  There friction is linear in v, as under eq. 1,

    (mu - mu_ref)/a = v + sum_k beta_k psi_k,     w = V/V_ref = exp(v) - exp(-v - 2 Theta),

with forward and backward jumps over barriers of the height Theta = mu_ref/a + sum_k beta_k psi_k.
All of it is smooth at rest, and where backward jumps are rare v is what it is under other laws.

Slopes are derivatives by omega at constant psi, and by psi at constant w, with d omega = dw/c and
c = dw/dv, the sum of all jumps.  Where nothing reverses c is w, and omega is v.
"""

import math
from typing import Any

from .force_balance import ConstantNormalStress
from .functions import (
    added,
    asinh_of,
    larger,
    log,
    scaled,
    weighted,
    weighted_sum,
    zeros_for,
)

#: beyond it, either way, the engine's exponentials saturate: a speed of 1e-260 V_ref is rest
LIMIT = 600.0
# The smallest part of c as which a speed is told from 0, and that is taken for the fastest speed.
SMALLEST, LEAST = 1e-16, 1e-6


class Forward(ConstantNormalStress):
    """Slip that never reverses.

    ==========  ================================================================
    v, psi, p   as for a law, and w = V/V_ref
    e           exponentials: of `backward_exponent`, then of `own_exponents`
    c_inverse   1/c
    ==========  ================================================================
    """

    #: whether slip may reverse
    reverses = False
    # of the law
    exponents: Any
    resistance: Any
    resistance_partials: Any
    evolution_effects: Any
    rates: Any
    rate_partials: Any
    rate_partials_2: Any

    # In compiled code

    def backward_exponent(self, v, psi, p):
        """ln of the rate of backward jumps, a tuple; () where there are none."""
        return ()

    def net_speed(self, forward, inverse, back):
        """w and 1/c, from exp(v), exp(-v) and the rates of backward jumps, a tuple."""
        return forward, inverse

    def speed_slope(self, w, e):
        """c = dw/dv."""
        return w

    def log_of_faster(self, v, psi, p):
        """ln of the rate of forward or of backward jumps, whichever is larger."""
        return v

    def order_of_speed(self, v, w):
        """A number that rises with w: v where that is possible, for its digits at rest."""
        return v

    def v_of_order(self, number, psi, p):
        """v, at psi = 0, of the speed of this `order_of_speed`."""
        return number

    def order_slope(self, w, psi, e, p):
        """The derivative of `v_of_order` by omega."""
        return 1.0

    def shares(self, e, c_inverse, p):
        """s_k of d omega = dv + sum_k s_k d psi_k, a tuple; () where they are 0."""
        return ()

    def error_of_v(self, error, w_new, e_new, fastest):
        """How far a step is off in v, given by how much v itself is, and where it ends.

        fastest : largest and smallest `order_of_speed` so far, and the load point's speed
        """
        return error

    def without_rounding(self, error, y, w, e, p, inertia, rounding, size, allowed):
        """`error_of_v`, less where rounding feigns more of it in v than is allowed.

        inertia : eta0/h; rounding : as a part of the numbers in y = (x, v, psi) and in p
        size : of x and psi
        """
        return error

    def own_exponents(self, v, w, psi, back, p):
        """The law's `exponents`."""
        return self.exponents(v, w, psi, p)

    def resistance_in_v(self, v, w, psi, p):
        """The law's `resistance`."""
        return self.resistance(v, w, psi, p)

    def resistance_slopes(self, v, w, psi, e, p):
        """Slopes of `resistance_in_v`: by omega and by each of psi, a tuple."""
        return self.resistance_partials(v, w, psi, p)

    def inertia_slopes(self, g, slopes, m, v, w, psi, e, p):
        """Slopes of -m dv/dT, where dv/dT = g/(eta0 c) - sum_k s_k dpsi_k/dT.

        m : eta0 c, held constant; g : x less the stress, or 0 at rest; slopes : `stress_slopes`
        """
        by_v, by_psi = slopes
        return by_v + g, by_psi

    def evolution(self, v, w, psi, e, p):
        """The law's `rates`."""
        return self.rates(v, w, psi, e, p)

    def evolution_slopes(self, v, w, psi, e, p):
        """Slopes of `evolution`: by omega, a tuple, and each by its own state, a tuple."""
        return self.rate_partials(v, w, psi, e, p)

    def v_at(self, w, psi, p):
        """v at the speed w, of arrays too."""
        return log(w)

    # Of arrays

    def speed(self, v, psi, p):
        """w, as compiled code has it, but where it saturates far up."""
        import numpy as np

        with np.errstate(over="ignore"):  # without mass V may overflow, and come back
            return np.exp(np.maximum(v, -LIMIT))


class Reversing(Forward):
    """Slip that may reverse, by friction that is linear in v and psi; laws of state are given |V|.

    A law of this kind has `barrier`, and nothing but `evolution_effects` of each state.
    """

    reverses = True

    def barrier(self, psi, p):
        """Theta."""
        raise NotImplementedError

    def backward_exponent(self, v, psi, p):
        """-v - 2 Theta."""
        return (-v - 2.0 * self.barrier(psi, p),)

    def net_speed(self, forward, inverse, back):
        """w and 1/c: the difference of all jumps, and one over their sum."""
        return forward - back[0], 1.0 / (forward + back[0])

    def speed_slope(self, w, e):
        """c, the sum of all jumps."""
        return w + 2.0 * e[0]

    def log_of_faster(self, v, psi, p):
        """ln of the rate of forward or of backward jumps, whichever is larger."""
        return larger(v, -v - 2.0 * self.barrier(psi, p))

    def order_of_speed(self, v, w):
        """w itself."""
        return w

    def v_of_order(self, number, psi, p):
        """v, at psi = 0, of this speed."""
        return self.v_at(number, zeros_for(psi), p)

    def order_slope(self, w, psi, e, p):
        """The derivative of `v_of_order` by omega: the sum of all jumps over that at psi = 0."""
        rest = math.exp(-min(self.barrier(zeros_for(psi), p), LIMIT))
        return self.speed_slope(w, e) / math.hypot(w, 2.0 * rest)

    def shares(self, e, c_inverse, p):
        """s_k of d omega = dv + sum_k s_k d psi_k, a tuple."""
        return scaled(2.0 * e[0] * c_inverse, self.evolution_effects(p))

    def error_of_v(self, error, w_new, e_new, fastest):
        """Off in v, which is friction, and in the speed, where friction hardly depends on it.

        In the speed as a part of the fastest that there is in the run.
        """
        c = self.speed_slope(w_new, e_new)
        largest = larger(larger(fastest[0], -fastest[1]), larger(abs(w_new), fastest[2]))
        return error * larger(1.0, c / larger(largest, LEAST * c))

    def size(self, w, e):
        """|w|, but never quite 0, of which the logarithm is taken."""
        return larger(abs(w), SMALLEST * self.speed_slope(w, e))

    def own_exponents(self, v, w, psi, back, p):
        """The law's `exponents` at |V|."""
        size = self.size(w, back)
        return self.exponents(log(size), size, psi, p)

    def resistance_in_v(self, v, w, psi, p):
        """(mu - mu_ref)/a."""
        return v + weighted_sum(self.evolution_effects(p), psi)

    def resistance_slopes(self, v, w, psi, e, p):
        """Slopes of `resistance_in_v`: by omega and by each of psi, a tuple."""
        return 1.0, scaled(w / self.speed_slope(w, e), self.evolution_effects(p))

    def inertia_slopes(self, g, slopes, m, v, w, psi, e, p):
        """Slopes of -m dv/dT, with those of 1/c and of s_k: of t = w/c they are 1 - t^2 by v."""
        effects, t = self.evolution_effects(p), w / self.speed_slope(w, e)
        evolution = m * weighted_sum(effects, self.rates_in_v(v, w, psi, e, p))
        bend = (2.0 * e[0] / self.speed_slope(w, e)) * (1.0 + t)
        by_omega, by_psi = slopes
        drop = scaled(-bend * (g + evolution * t), effects)
        return by_omega + g * t - evolution * bend, added(by_psi, drop)

    def evolution(self, v, w, psi, e, p):
        """The law's `rates` at |V|."""
        size = self.size(w, e)
        return self.rates(log(size), size, psi, e[1:], p)

    def evolution_slopes(self, v, w, psi, e, p):
        """Slopes of `evolution`: by omega, a tuple, and each by its own state, a tuple."""
        size = self.size(w, e)
        by_log, by_psi = self.rate_partials(log(size), size, psi, e[1:], p)
        return scaled(self.log_slope(w, e), by_log), by_psi

    def log_slope(self, w, e):
        """d ln |w|/d omega."""
        c = self.speed_slope(w, e)
        return (c if w > 0.0 else -c) / self.size(w, e)

    def rates_bent(self, w, psi, e, p, one, other, bend_of_w):
        """Second derivatives of `evolution` in two directions.

        one, other : d omega and d psi of each; bend_of_w : of w the second derivative, over c
        """
        size, slope = self.size(w, e), self.log_slope(w, e)
        log_size = log(size)
        by_log, _ = self.rate_partials(log_size, size, psi, e[1:], p)
        log_log, log_psi, psi_psi = self.rate_partials_2(log_size, size, psi, e[1:], p)
        first, second = slope * one[0], slope * other[0]
        bent = scaled(slope * bend_of_w - first * second, by_log)
        bent = added(bent, scaled(first * second, log_log))
        mixed = added(scaled(first, other[1]), scaled(second, one[1]))
        bent = added(bent, weighted(log_psi, mixed))
        return added(bent, weighted(psi_psi, weighted(one[1], other[1])))

    def decay_slopes(self, w, psi, e, p):
        """Slopes of the derivative of each rate by its own state: by omega, and by that state."""
        size = self.size(w, e)
        _, log_psi, psi_psi = self.rate_partials_2(log(size), size, psi, e[1:], p)
        return scaled(self.log_slope(w, e), log_psi), psi_psi

    def v_at(self, w, psi, p):
        """v at the speed w, of arrays too."""
        barrier = self.barrier(psi, p)
        return asinh_of(w, barrier) - barrier

    def speed(self, v, psi, p):
        """w, but where the engine's saturates far up."""
        import numpy as np

        back = -v - 2.0 * self.barrier(psi, p)
        with np.errstate(over="ignore"):
            return np.exp(np.maximum(v, -LIMIT)) - np.exp(np.maximum(back, -LIMIT))
