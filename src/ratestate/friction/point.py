"""A slider at one point: how fast it slips, and what the equations of motion say there.

The state is y = (x, v, psi), with a psi for each of the law's variables.  Under most laws
V = V_ref exp(v), which is never 0 nor negative.  Friction that stays finite at rest lets slip
reverse.  There v is friction itself, and mu_ref is 0,

    v = mu/a,     w = V/V_ref = exp(v - Theta) - exp(-v - Theta) = c t,     t = tanh v,

with forward and backward jumps over barriers of the height Theta = mu0/a + sum_k beta_k psi_k,
but for V_ref instead of V0, and c = 2 cosh(v) exp(-Theta) the sum of all jumps.  All of it is
smooth at rest, and w keeps its digits however small friction is.

In either case c = dw/dv at constant psi, and d omega = dw/c.  If slip never reverses, c is w, and
omega is v.
"""

from functools import cached_property

from .expressions import LIMIT
from .functions import bounded_exp, exp, larger, log, smaller, sqrt, where
from .tuples import dot, dot_onto, minus_dot, product, select, times, total

# The smallest |w| that laws of state are given, and the least part of c that is taken for the
# fastest speed.
SMALLEST, LEAST = 1e-100, 1e-6
# Of x and of the parts of friction, by which g = x - S may be off.
ROUNDING_OF_FORCE = 1e-13


class Point:
    """A slider at one point, in numbers of any kind: what is known there, and what follows.

    Each list of `motion.Motion` that needs no other numbers is an attribute.

    Parameters
    ----------
    law, p : the law, and its coefficients
    y : x, v and each psi, a tuple
    w, e : the speed, and what the engine keeps beside: c if slip may reverse, and the exponentials
        that rates hold; both follow from v if they are None
    c_inverse : 1/c, if it is at hand
    kappa, eta0 : as of `engine.model`
    motion : the equations of motion; by default those of the engine
    """

    def __init__(
        self, law, p, y, w=None, e=None, c_inverse=None, kappa=None, eta0=None, motion=None
    ):
        self.law, self.motion, self.p, self.y = law, motion or law.motion, p, y
        self.x, self.v, self.psi = y[0], y[1], tuple(y[2:])
        self.w, self.e, self.kappa, self.eta0 = w, e, kappa, eta0
        if c_inverse is not None:
            self.c_inverse = c_inverse

    def at(self, y, dT=None):
        """The slider at another state, which may be a time dT later."""
        p = self.p if dT is None else self.law.later(self.p, dT)
        return point_at(self.law, p, y, self.kappa, self.eta0)

    def later(self, dT):
        """The same state a time dT later, when normal stress may be another."""
        p = self.law.later(self.p, dT)
        return Point(self.law, p, self.y, self.w, self.e, None, self.kappa, self.eta0)

    @cached_property
    def known(self):
        """Symbols of `motion` -> values."""
        motion, own = self.motion, self.motion.own
        known = dict(zip((motion.v, *motion.psi), (self.v, *self.psi), strict=True))
        known |= dict(zip(motion.p, self.p, strict=False)) | {motion.symbols["moves"]: 1.0}
        if self.w is not None:
            known[motion.w] = self.w
        if self.e is None:
            return known
        if motion.reverses:  # (the logarithm of a smaller |w| would be lost)
            size, c = larger(abs(self.w), SMALLEST), self.c
            known |= {own.v: log(size), own.w: size, motion.c: c, motion.t: self.w / c}
            known[motion.slope] = where(self.w > 0.0, c, -c) / size
        return known | dict(zip(own.exponentials, self.e[motion.reverses :], strict=False))

    def values(self, name, **numbers):
        """A list of `motion`, with these values of its other symbols."""
        known = dict(self.known)
        for symbol, x in ((self.motion.symbols[one], x) for one, x in numbers.items()):
            known |= zip(symbol, x, strict=True) if isinstance(symbol, list) else {symbol: x}
        return self.motion.values(name, known)

    def __getattr__(self, name):
        if name.startswith("_"):  # (what Python asks for)
            raise AttributeError(name)
        found = self.__dict__[name] = self.values(name)
        return found

    @cached_property
    def c(self):
        """dw/dv at constant psi: if slip may reverse the sum of all jumps."""
        return self.e[0] if self.motion.reverses else self.w

    @cached_property
    def c_inverse(self):
        return 1.0 / self.c

    @cached_property
    def m(self):
        return self.eta0 * self.c

    @cached_property
    def shares(self):
        """s_k = -t beta_k of d omega = dv + sum_k s_k d psi_k, a tuple; () if they are 0."""
        if not self.motion.reverses:
            return ()
        return times(-self.w * self.c_inverse, self.law.evolution_effects(self.p))

    def in_omega(self, z):
        """A change of x, omega and psi, from that of x, v and psi."""
        return z[0], dot_onto(z[1], self.shares, z[2:]), *z[2:]

    def in_v(self, z):
        """The inverse of `in_omega`."""
        return z[0], minus_dot(z[1], self.shares, z[2:]), *z[2:]

    @cached_property
    def log_of_faster(self):
        """ln of the rate of forward or of backward jumps, whichever is larger."""
        return self.law.log_of_faster(self.v, self.psi, self.p)

    @property
    def order_of_speed(self):
        """A number that rises with w: v where that is possible, for its digits at rest."""
        return self.w if self.motion.reverses else self.v

    @property
    def order_slope(self):
        """The derivative by omega of v at psi = 0 and this speed."""
        if not self.motion.reverses:
            return 1.0
        at_0 = self.law.barrier((0.0,) * len(self.psi), self.p)
        rest = 2.0 * exp(-smaller(at_0, LIMIT))
        size = larger(abs(self.w), rest)
        part = smaller(abs(self.w), rest) / size
        return self.c / (size * sqrt(1.0 + part * part))

    def error_of_v(self, error, fastest):
        """Error in omega of a step that ends here, from its error in x, v and psi.

        If friction hardly depends on the speed, that in the speed, as a part of the fastest one.

        fastest : largest and smallest `order_of_speed` so far, and the load point's speed
        """
        if not self.motion.reverses:
            return error[1]
        omega = abs(error[1] + dot(self.shares, error[2:]))
        largest = larger(larger(fastest[0], -fastest[1]), larger(abs(self.w), fastest[2]))
        return omega * larger(1.0, self.c / larger(largest, LEAST * self.c))

    @cached_property
    def g(self):
        """The inertial force."""
        return self.x - self.S

    @property
    def forces(self):
        """x, S, N and R."""
        return self.x, self.S, self.N, self.R

    def changes_of_forces(self, change, dT):
        """How much `forces` change with x, omega and psi, and in a time dT."""
        return change[0], *self.values("changes", z=change, dT=dT)

    def works(self, w_lp):
        """Powers per a sigma V0 beyond their mu_ref part: of the load point, of the stress S."""
        return self.x * w_lp, self.S * self.w

    def of_x(self, w_lp):
        """dx/dT where this is the load point's speed."""
        return self.kappa * (w_lp - self.w)

    def drive(self, w_lp):
        """d(x - S)/dT at constant w."""
        return self.of_x(w_lp) - dot(self.S_slopes[1:], self.f) - total(self.N_drift)

    @cached_property
    def is_balanced(self):
        """Whether inertia is lost in the rounding of forces, so that x is S."""
        by_omega, *by_psi = self.S_slopes
        of_psi = total(map(abs, product(by_psi, self.psi)))
        sizes = abs(self.x) + abs(by_omega * self.v) + of_psi
        return (abs(self.g) <= ROUNDING_OF_FORCE * sizes) | (self.m <= 0.0)

    def acceleration(self, w_lp, balanced):
        """d omega/dT as a quotient: of g and m or, where inertia is lost, from x = S."""
        return select(balanced, (self.drive(w_lp), self.S_slopes[0]), (self.g, self.m))

    def derived(self, name, **numbers):
        """A list of `motion` that holds q, m, and g or F."""
        g = where(self.log_of_faster > -LIMIT, self.g, 0.0)  # at rest w is a constant
        F = dot(self.law.evolution_effects(self.p), self.f) if self.motion.reverses else 0.0
        return self.values(name, **({"g": g, "F": F} | numbers))


def point_at(law, p, y, kappa=None, eta0=None):
    """A `Point` whose speed and exponentials are the engine's, from v."""
    w, c_inverse, kept = law.net_speed(y[1], y[2:], p)
    system = c_inverse, kappa, eta0
    exponents = Point(law, p, y, w, kept, *system).exponents
    return Point(law, p, y, w, (*kept, *map(bounded_exp, exponents)), *system)
