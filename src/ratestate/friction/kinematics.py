"""How fast a slider slips, from the variables x, v and psi that the engine integrates.

Under most laws V = V_ref exp(v), which is never 0 nor negative.  Friction that stays finite at rest
lets slip reverse.  There v is friction itself, and mu_ref is 0,

    v = mu/a,     w = V/V_ref = exp(v - Theta) - exp(-v - Theta) = c t,     t = tanh v,

with forward and backward jumps over barriers of the height Theta = mu0/a + sum_k beta_k psi_k,
but for V_ref instead of V0, and c = 2 cosh(v) exp(-Theta) the sum of all jumps.  All of it is
smooth at rest, and w keeps its digits however small friction is.

In either case c = dw/dv at constant psi, and d omega = dw/c.  If slip never reverses, c is w, and
omega is v.
"""

from typing import Any

from .expressions import LIMIT
from .functions import asinh_of, bounded_exp, exp, exp_and_inverse, larger, log, smaller, sqrt, tanh
from .tuples import dot, times

# The smallest |w| that laws of state are given, and the least part of c that is taken for the
# fastest speed.
SMALLEST, LEAST = 1e-100, 1e-6


class Forward:
    """Slip that never reverses.

    v, psi and p are as for a law, w = V/V_ref, and e is what `net_speed` keeps, then exponentials
    of the law's `exponents` at the `magnitude` of w.
    """

    #: whether slip may reverse
    reverses = False

    # In compiled code

    def net_speed(self, v, psi, p):
        """w, 1/c, and in a tuple what `e` keeps of them."""
        return *exp_and_inverse(v), ()

    def magnitude(self, v, w):
        """ln |w| and |w|, as laws of state are given them."""
        return v, w

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

    def shares(self, w, c_inverse, p):
        """s_k of d omega = dv + sum_k s_k d psi_k, a tuple; () if they are 0."""
        return ()

    def error_of_v(self, error, w_new, e_new, p, fastest):
        """Error of a step in omega, from its error in x, v and psi, a tuple, and where it ends.

        fastest : largest and smallest `order_of_speed` so far, and the load point's speed
        """
        return error[1]

    def without_rounding(self, error, y, w, e, p, inertia, rounding, size, allowed):
        """`error_of_v`, less where rounding feigns more of it in v than is allowed.

        inertia : eta0/h; rounding : as a part of the numbers in y = (x, v, psi) and in p
        size : of x and psi
        """
        return error

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
    """Slip that may reverse, where v is mu/a; laws of state are given |V|.

    A law of this kind has `barrier`, and nothing but `evolution_effects` of each state.
    """

    reverses = True
    evolution_effects: Any  # of the law

    def barrier(self, psi, p):
        """Theta."""
        raise NotImplementedError

    def net_speed(self, v, psi, p):
        """w, 1/c, and c in a tuple."""
        t = tanh(v)
        c = bounded_exp(self.log_of_faster(v, psi, p)) * (2.0 / (1.0 + abs(t)))
        return c * t, 1.0 / c, (c,)

    def magnitude(self, v, w):
        """ln |w| and |w|, but not so small that the logarithm is lost."""
        size = larger(abs(w), SMALLEST)
        return log(size), size

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
        """s_k = -t beta_k of d omega = dv + sum_k s_k d psi_k, a tuple."""
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

    def v_at(self, w, psi, p):
        """v at the speed w, of arrays too."""
        return asinh_of(w, self.barrier(psi, p))

    def speed(self, v, psi, p):
        """w, but where the engine's saturates far up."""
        import numpy as np

        t = np.tanh(v)
        with np.errstate(over="ignore"):
            jumps = np.exp(np.maximum(self.log_of_faster(v, psi, p), -LIMIT))
            return jumps * (2.0 / (1.0 + np.abs(t))) * t
