"""How fast a slider slips, from the variables x, v and psi that the engine integrates.

Under most laws V = V_ref exp(v), which is never 0 nor negative.  Friction that stays finite at rest
lets slip reverse: there v is friction over a, mu/a (`reversing`).

Slopes are derivatives by omega at constant psi, and by psi at constant w, with d omega = dw/c and
c = dw/dv.  If slip never reverses, c is w, and omega is v.
"""

from typing import Any

from .expressions import LIMIT
from .force_balance import ConstantNormalStress
from .functions import log


class Forward(ConstantNormalStress):
    """Slip that never reverses.

    ==========  ================================================================
    v, psi, p   as for a law, and w = V/V_ref
    e           what `net_speed` keeps, then exponentials of `own_exponents`
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

    def jump_exponents(self, v, psi, p):
        """`log_of_faster` in a tuple if slip may reverse, else ()."""
        return ()

    def net_speed(self, v, forward, inverse, jumps):
        """w, 1/c, and in a tuple what `e` keeps of them.

        forward, inverse : exp(v), exp(-v); jumps : exponentials of `jump_exponents`, a tuple
        """
        return forward, inverse, ()

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

    def own_exponents(self, v, w, psi, p):
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

    def state_rates(self, v, w, psi, e, p):
        """The law's `rates`."""
        return self.rates(v, w, psi, e, p)

    def state_rate_slopes(self, v, w, psi, e, p):
        """Slopes of `state_rates`: by omega, a tuple, and each by its own state, a tuple."""
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
