"""The aging (Dieterich) law: state evolves at rest too."""

import math

from ..law import FrictionLaw


class AgingLaw(FrictionLaw):
    """d theta/dt = 1 - V theta/Dc (eq. 2 of Im, Marone & Elsworth, 2019).

    Source: Dieterich (1979) doi:10.1029/JB084iB05p02161.
    """

    name = "aging"
    label = "aging (Dieterich) law"
    synonyms = ("ageing", "dieterich", "slowness")
    one_length = True
    series = tuple((-1) ** k / math.factorial(k) for k in range(2, 15))  # h = exp(-z) - 1

    def evolution(self, V, theta, p):
        """1 - V theta/Dc."""
        return 1.0 - V * theta / p.Dc

    def exponents(self, v, w, psi, p):
        """e = (exp(-psi),)."""
        return (-psi[0],)

    def rates(self, v, w, psi, e, p):
        """d psi/dT = exp(-psi) - w."""
        return (e[0] - w,)

    def rate_partials(self, v, w, psi, e, p):
        """Derivatives of `rates` with respect to v and to psi."""
        return (-w,), (-e[0],)

    def rate_partials_2(self, v, w, psi, e, p):
        """Second derivatives of `rates`: vv, v psi, psi psi."""
        return (-w,), (0.0,), (e[0],)

    def rate_partials_3(self, v, w, psi, e, p):
        """Third derivatives of `rates`: vvv, vv psi, v psi psi, psi psi psi."""
        return (-w,), (0.0,), (0.0,), (-e[0],)

    def heals_at_rest(self):
        """Whether state evolves without slip; here it does."""
        return True

    def runs_away(self, v, psi, kappa, p):
        """Whether exp(-y) <= 1 - kappa/c, where y = v + psi and kappa < c = b/a - 1.

        dy/dD = c (1 - exp(-y)) - kappa + kappa w_lp/w then stays positive.
        """
        c = p[0] - 1.0
        return c > kappa and v + psi[0] >= -math.log1p(-kappa / c)

    def held(self, psi, v, w, h, p):
        """psi after a time h at the constant speed w = exp(v), and its derivative by v."""
        decay = math.exp(-w * h)
        theta = math.exp(psi[0])
        grown = -math.expm1(-w * h) / w
        new = theta * decay + grown
        return (math.log(new),), ((w * h * decay * (1.0 / w - theta) - grown) / new,)

    def held_by_euler(self, psi, v, w, h, p):
        """What `held` gives, but by one step of backward Euler in theta."""
        new = math.log((math.exp(psi[0]) + h) / (1.0 + w * h))
        return (new,), (-w * h / (1.0 + w * h),)

    def relaxed(self, psi, v, v_end, slip, forced):
        """psi at the end of a slip [Dc] from the speed v to v_end, given the integral of `forcing`.

        The law is linear in theta V_ref/Dc = exp(psi): d exp(psi)/dD = -exp(psi) + 1/w.
        """
        return math.log(math.exp(psi) * math.exp(-slip) + forced)

    def forcing(self, curvature, part, w_end):
        """What drives exp(psi) with slip, 1/w, where (V/V_end)^2 is `part`."""
        return 1.0 / w_end / math.sqrt(part)

    def excursion(self, v, psi, kappa, beta):
        """E = kappa h(-psi) + h(-y), y = v + psi."""
        from ..convex import convex

        return kappa * convex(-psi) + convex(-(v + psi))

    def runaway_edge(self, kappa, beta, largest):
        """None: without mass every orbit comes back (Ranjith & Rice 1999)."""
        return math.inf, math.inf, math.inf
