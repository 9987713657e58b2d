"""The variational equations where slip may reverse: what `tangent` needs of the derivatives.

===========  ================================================================================
c, t, bend   the sum of all jumps, w/c, and 1 - t^2, its derivative by v
sigma, F     sum_k beta_k z_k of a direction z, and the same of the rates f
q, omega     changes of friction over a, z_v, and of w over c, q - t sigma
r            change of ln c, t q - sigma
===========  ================================================================================
"""

from ..friction.expressions import LIMIT
from ..friction.functions import where
from ..friction.tuples import dot, plus, product, times, total
from .equations import inertial_force


def speeds(w, e, law):
    """c, t and bend."""
    c = law.speed_slope(w, e)
    t = w / c
    return c, t, (1.0 - t) * (1.0 + t)


def changes(z, t, effects):
    """sigma, q and omega of a direction z."""
    sigma = dot(effects, z[2:])
    return sigma, z[1], z[1] - t * sigma


def slopes(u, at, system, start):
    """As `tangent.slopes`."""
    w, c_inverse, e = at
    law, kappa, eta0, p = system
    effects = law.evolution_effects(p)
    f_v, f_psi = law.rate_slopes(u[1], w, u[2:], e, p)
    g, S_v, _ = inertial_force(u, w, e, law, p)
    g = where(law.log_of_faster(u[1], u[2:], p) > -LIMIT, g, 0.0)
    c, t, bend = speeds(w, e, law)
    F = dot(effects, law.rates_in_v(u[1], w, u[2:], e, p))
    trace = total(f_psi) - (S_v + g * t) * (c_inverse / eta0) + bend * F
    of_speed = start.c * c_inverse, g, kappa * c, S_v, t, bend
    return (*of_speed, F, effects, f_v, f_psi), trace


def change_of_rows(du, at, m):
    """J du, its v row times m, from what `slopes` gave."""
    ratio, g, kappa_c, S_v, t, bend, F, effects, f_v, f_psi = at
    sigma, q, omega = changes(du, t, effects)
    df = plus(times(omega, f_v), product(f_psi, du[2:]))
    dg = du[0] - S_v * omega - t * sigma
    inertia = ratio * (dg - g * (t * q - sigma))
    return -kappa_c * omega, inertia + m * (bend * F * q + t * dot(effects, df)), *df


def second_derivatives(y, w, e, z, system):
    """What `bent` needs of J'(y) z: of the point, and of the direction."""
    law, _, _, p = system
    effects = law.evolution_effects(p)
    f_v, f_psi = law.rate_slopes(y[1], w, y[2:], e, p)
    g, S_v, _ = inertial_force(y, w, e, law, p)
    moves = where(law.log_of_faster(y[1], y[2:], p) > -LIMIT, 1.0, 0.0)
    c, t, bend = speeds(w, e, law)
    sigma, q, omega = changes(z, t, effects)
    df = plus(times(omega, f_v), product(f_psi, z[2:]))
    F = dot(effects, law.rates_in_v(y[1], w, y[2:], e, p))
    dg = z[0] - S_v * omega - t * sigma
    point = y, w, e, system, effects, f_v, f_psi, moves * g, S_v, moves, c, t, bend, F
    return point, (z, sigma, q, omega, moves * (t * q - sigma), dg, dot(effects, df))


def bent(curvature, k):
    """(J'(y) z) k, its v row times eta0 c, from what `second_derivatives` gave."""
    point, along = curvature
    y, w, e, system, effects, f_v, f_psi, g, S_v, moves, c, t, bend, F = point
    z, sigma, q, omega, r, dg, dF = along
    law, kappa, eta0, p = system
    sigma_k, q_k, omega_k = changes(k, t, effects)
    r_k = moves * (t * q_k - sigma_k)
    df_k = plus(times(omega_k, f_v), product(f_psi, k[2:]))
    dg_k = k[0] - S_v * omega_k - t * sigma_k
    # of forward jumps, (1 + t)/2 of all, q - sigma is the change of their logarithm; of backward
    # jumps -q - sigma
    forward, backward = (q - sigma) * (q_k - sigma_k), (q + sigma) * (q_k + sigma_k)
    w_bent = 0.5 * moves * ((1.0 + t) * forward - (1.0 - t) * backward)
    directions = (omega, z[2:]), (omega_k, k[2:])
    f_bent = law.rates_bent(w, y[2:], e, p, *directions, w_bent)
    inertia = g * (r * r_k - bend * q * q_k) - dg * r_k - dg_k * r - (S_v - 1.0) * w_bent
    bends = bend * (2.0 * t * q * q_k * F - q * dot(effects, df_k) - q_k * dF)
    evolution = bends - t * dot(effects, f_bent)
    return -kappa * c * w_bent, inertia - eta0 * c * evolution, *f_bent


def trace_along(y, w, e, dy, system):
    """The derivative of the trace of J in the direction dy."""
    law, _, eta0, p = system
    point, along = second_derivatives(y, w, e, dy, system)
    _, _, _, _, _, _, _, g, S_v, moves, c, t, bend, F = point
    _, _, q, omega, r, dg, dF = along
    by_omega, by_psi = law.decay_slopes(w, y[2:], e, p)
    decay = total(by_omega) * omega + dot(by_psi, dy[2:])
    # of (S_v + g t)/(eta0 c), in which S_v is 1 + zeta c
    pull = (S_v - 1.0) * r + moves * dg * t + g * bend * q - (S_v + g * t) * r
    return decay - pull / (eta0 * c) + bend * (dF - 2.0 * t * q * F)


def right_hand_side(du, at, k, rest, curvature, r, m):
    """As `tangent.right_hand_side`."""
    first, second = change_of_rows(du, at, m), bent(curvature, k)
    r_x = r * rest[0] + first[0] + second[0]
    r_v = first[1] + (m * r) * rest[1] + second[1]
    r_psi = plus(plus(first[2:], times(r, rest[2:])), second[2:])
    return r_x, r_v, *r_psi
