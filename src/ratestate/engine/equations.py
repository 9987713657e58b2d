"""The equations at one point: its speed and exponentials, the force there, and its power.

A point is u or y = (x, v, psi), with a psi for each of the law's variables; the equations are those
of `model`.
"""

from ..friction.expressions import LIMIT
from ..friction.functions import bounded_exp, where
from ..friction.tuples import dot, dot_onto


def exponentials(u, law, p):
    """w, 1/c and e of `kinematics` at u."""
    w, c_inverse, kept = law.net_speed(u[1], u[2:], p)
    exponents = law.exponents(*law.magnitude(u[1], w), u[2:], p)
    return w, c_inverse, (*kept, *map(bounded_exp, exponents))


def in_omega(z, shares):
    """A change of x, omega and psi, from that of x, v and psi."""
    return z[0], dot_onto(z[1], shares, z[2:]), *z[2:]


def forces(y, w, law, p):
    """x, S, N and R at y."""
    here = y[1], w, y[2:], p
    return y[0], law.stress_in_v(*here), law.strength_in_v(*here), law.resistance_in_v(*here)


def force_slopes(y, w, e, change, dT, law, p):
    """How much x, S, N and R change with x, omega and psi, and in a time dT."""
    return change[0], *law.motion("force_slopes", y[1], w, y[2:], p, e, z=change, dT=dT)


def inertial_force(y, w, e, law, p):
    """g = x - S, and the slopes of the stress S by omega and by psi, at y = (x, v, psi)."""
    S_v, S_psi = law.stress_slopes(y[1], w, y[2:], e, p)
    return y[0] - law.stress_in_v(y[1], w, y[2:], p), S_v, S_psi


def derived(name, y, w, e, law, p, **numbers):
    """One of the lists of `motion.Motion` at y, in which q, m and others are these numbers."""
    v, psi = y[1], y[2:]
    # at rest w is a constant (`bounded_exp`)
    g = where(law.log_of_faster(v, psi, p) > -LIMIT, y[0] - law.stress_in_v(v, w, psi, p), 0.0)
    F = dot(law.evolution_effects(p), law.rates_in_v(v, w, psi, e, p)) if law.reverses else 0.0
    return law.motion(name, v, w, psi, p, e, **({"g": g, "F": F} | numbers))


def later(system, dT):
    """The system at a time dT later."""
    law, kappa, eta0, p = system
    return law, kappa, eta0, law.later(p, dT)


def works(u, w, w_lp, system):
    """Powers per a sigma V0 beyond their mu_ref part: of the load point; of what opposes motion."""
    return u[0] * w_lp, system[0].stress_in_v(u[1], w, u[2:], system[3]) * w
