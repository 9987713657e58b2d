"""A slider's speed and the right-hand sides of its equations of motion, for one state.

The state is y = (x, v, psi), with one psi for each of the law's variables.  Under most laws
V = V_ref exp(v), which is always positive.  If friction stays finite at rest, slip may reverse.
Then v is friction itself, mu_ref is 0, and

    v = mu/a,     w = V/V_ref = exp(v - Theta) - exp(-v - Theta) = c t,     t = tanh v,

the rate of forward minus the rate of backward jumps over barriers.  The height of the barriers is
Theta = mu0/a + sum_k beta_k psi_k, with mu0 at V_ref instead of V0, and c = 2 cosh(v) exp(-Theta)
is the rate of all jumps.  All functions are smooth at rest, and w keeps its digits however small
friction is.

In either case c = dw/dv at constant psi, and d omega = dw/c.  If slip never reverses, c is w, and
omega is v.
"""

from functools import cached_property

from .expressions import LIMIT
from .functions import bounded_exp, exp, larger, log, smaller, sqrt, where
from .tuples import dot, dot_onto, minus_dot, product, select, times, total

# Lower limits of |w| in formulas of laws, and of the fastest speed divided by c.
SMALLEST_SPEED, SMALLEST_RATIO = 1e-100, 1e-6
# Error of g = x - S, relative to x and the parts of friction.
ROUNDING_OF_FORCE = 1e-13


class Point:
    """A slider at one point, in numbers of any kind.

    Each list of `equations_of_motion.Motion` that needs no other numbers is an attribute.

    Parameters
    ----------
    law, p : the law, and its coefficients
    y : x, v and each psi, a tuple
    w, e : the speed, and the numbers stored with it: c if slip may reverse, and the exponentials in
        the rates; None to compute them from v
    c_inverse : 1/c, if known
    kappa, eta0 : as in `engine.model`
    motion : the equations of motion; by default in the engine's variables
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
        """Return the slider at another state, perhaps a time dT later."""
        p = self.p if dT is None else self.law.later(self.p, dT)
        return point_at(self.law, p, y, self.kappa, self.eta0)

    def later(self, dT):
        """Return the same state a time dT later, if normal stress may have changed."""
        p = self.law.later(self.p, dT)
        return Point(self.law, p, self.y, self.w, self.e, None, self.kappa, self.eta0)

    @cached_property
    def symbol_values(self):
        """Return the values of the symbols of `motion`, a dict."""
        motion, equations = self.motion, self.motion.equations
        known = dict(zip((motion.v, *motion.psi), (self.v, *self.psi), strict=True))
        known |= dict(zip(motion.p, self.p, strict=False)) | {motion.symbols["moves"]: 1.0}
        if self.w is not None:
            known[motion.w] = self.w
        if self.e is None:
            return known
        if motion.reverses:  # the limit keeps ln |w| finite
            size, c = larger(abs(self.w), SMALLEST_SPEED), self.c
            known |= {equations.v: log(size), equations.w: size}
            known |= {motion.c: c, motion.t: self.w / c}
            known[motion.slope] = where(self.w > 0.0, c, -c) / size
        return known | dict(zip(equations.exponentials, self.e[motion.reverses :], strict=False))

    def values(self, name, **numbers):
        """Return a list of `motion`, with these values of its other symbols."""
        inputs = dict(self.symbol_values)
        for symbol, x in ((self.motion.symbols[key], x) for key, x in numbers.items()):
            inputs |= zip(symbol, x, strict=True) if isinstance(symbol, list) else {symbol: x}
        return self.motion.values(name, inputs)

    def __getattr__(self, name):
        if name.startswith("_"):  # a special method that Python looks up
            raise AttributeError(name)
        values = self.__dict__[name] = self.values(name)
        return values

    @cached_property
    def c(self):
        """Return dw/dv at constant psi; the rate of all jumps if slip may reverse."""
        return self.e[0] if self.motion.reverses else self.w

    @cached_property
    def c_inverse(self):
        return 1.0 / self.c

    @cached_property
    def m(self):
        return self.eta0 * self.c

    @cached_property
    def omega_by_psi(self):
        """Return s_k = -t beta_k of d omega = dv + sum_k s_k d psi_k; () if all are 0."""
        if not self.motion.reverses:
            return ()
        return times(-self.w * self.c_inverse, self.law.evolution_effects(self.p))

    def in_omega(self, z):
        """Convert a change of x, v and psi to a change of x, omega and psi."""
        return z[0], dot_onto(z[1], self.omega_by_psi, z[2:]), *z[2:]

    def in_v(self, z):
        """Convert a change of x, omega and psi to a change of x, v and psi."""
        return z[0], minus_dot(z[1], self.omega_by_psi, z[2:]), *z[2:]

    @cached_property
    def log_jump_rate(self):
        return self.law.log_jump_rate(self.v, self.psi, self.p)

    @property
    def speed_measure(self):
        """Return a measure that rises with w: w if slip may reverse, else v."""
        return self.w if self.motion.reverses else self.v

    @property
    def reference_v_slope(self):
        """Return the derivative by omega of the v that has this speed at psi = 0."""
        if not self.motion.reverses:
            return 1.0
        barrier = self.law.barrier((0.0,) * len(self.psi), self.p)
        rest = 2.0 * exp(-smaller(barrier, LIMIT))
        size = larger(abs(self.w), rest)
        ratio = smaller(abs(self.w), rest) / size
        return self.c / (size * sqrt(1.0 + ratio * ratio))

    def error_of_v(self, error, fastest):
        """Return the error in omega of a step that ends here, from that in x, v and psi.

        If friction hardly depends on speed, it is the error of speed relative to the fastest speed.

        fastest : largest and smallest `speed_measure` so far, and the load point's speed
        """
        if not self.motion.reverses:
            return error[1]
        omega = abs(error[1] + dot(self.omega_by_psi, error[2:]))
        largest = larger(larger(fastest[0], -fastest[1]), larger(abs(self.w), fastest[2]))
        return omega * larger(1.0, self.c / larger(largest, SMALLEST_RATIO * self.c))

    @cached_property
    def g(self):
        """Return the inertial force x - S."""
        return self.x - self.S

    @property
    def forces(self):
        return self.x, self.S, self.N, self.R

    def changes_of_forces(self, change, dT):
        """Return the changes of `forces` along a change of x, omega, psi, in a time dT."""
        return change[0], *self.values("changes", z=change, dT=dT)

    def work_rates(self, w_lp):
        """Return the powers of load point and S per a sigma V0, beyond their mu_ref part."""
        return self.x * w_lp, self.S * self.w

    def x_rate(self, w_lp):
        """Return dx/dT at this load-point speed."""
        return self.kappa * (w_lp - self.w)

    def g_rate(self, w_lp):
        """Return d(x - S)/dT at constant w."""
        return self.x_rate(w_lp) - dot(self.S_slopes[1:], self.f) - total(self.N_drift)

    @cached_property
    def is_balanced(self):
        """Return whether inertia is lost in the rounding of forces, so that x is S."""
        by_omega, *by_psi = self.S_slopes
        of_psi = total(map(abs, product(by_psi, self.psi)))
        sizes = abs(self.x) + abs(by_omega * self.v) + of_psi
        return (abs(self.g) <= ROUNDING_OF_FORCE * sizes) | (self.m <= 0.0)

    def acceleration(self, w_lp, balanced):
        """Return dividend and divisor of d omega/dT: g and m, or from x = S if balanced."""
        return select(balanced, (self.g_rate(w_lp), self.S_slopes[0]), (self.g, self.m))

    def derived(self, name, **numbers):
        """Return a list of `motion` that contains q, m, and g or F."""
        g = where(self.log_jump_rate > -LIMIT, self.g, 0.0)  # at rest w is a constant
        F = dot(self.law.evolution_effects(self.p), self.f) if self.motion.reverses else 0.0
        return self.values(name, **({"g": g, "F": F} | numbers))


def point_at(law, p, y, kappa=None, eta0=None):
    """Return a `Point` with the speed and exponentials that the engine computes."""
    w, c_inverse, kept = law.net_speed(y[1], y[2:], p)
    system = c_inverse, kappa, eta0
    exponents = Point(law, p, y, w, kept, *system).exponents
    return Point(law, p, y, w, (*kept, *map(bounded_exp, exponents)), *system)
