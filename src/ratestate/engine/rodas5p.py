"""One step of Rodas5P: Rosenbrock, 8 stages, order 5(4), stiffly accurate, with dense output.

Coefficients as published: Steinebach (2023), BIT Numer. Math. 63, 27,
doi:10.1007/s10543-023-00967-x, in the transformed form of Hairer & Wanner (1996, IV.7), where

    (1/(gamma h) - J) k_i = f(T + c_i h, y + sum_j A_ij k_j) + sum_j (C_ij/h) k_j + h d_i df/dT
    y_new = y + sum_j A_8j k_j + k_8,      error estimate = k_8.

The system is that of `model`: y = (x, v, psi).  Two things are done with its shape.

* J is an arrow (x and psi each couple to v alone), so one scalar pivot solves each stage.
* The v row is multiplied by m = eta0 w(v at the start), which turns dv/dT = g/(eta0 w) into
  m dv/dT = g w_start/w.  Nothing overflows as V -> 0, and eta0 = 0 is a regular case: the row
  then reads k_v = k_x - beta k_psi and a linearly implicit method keeps v = x - beta psi.
  What remains is this same method on the two variables x and psi, so the quasi-static limit
  needs no code of its own.

Beside the state, a step integrates the load-point work and the frictional dissipation with the
weights `B` that the method implies for a pure quadrature.
"""

from ..friction.laws import SLIP
from .exp import LIMIT, exp, exp_and_inverse
from .jit import inlined
from .model import state_rate, state_rate_partials

GAMMA = 0.21193756319429014
A = (
    (),
    (3.0,),
    (2.849394379747939, 0.45842242204463923),
    (-6.954028509809101, 2.489845061869568, -10.358996098473584),
    (2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641),
    (
        -7.502846399306121,
        2.561846144803919,
        -11.627539656261098,
        -0.18268767659942256,
        0.030198172008377946,
    ),
)  # stages 7 and 8 add k_6 and k_7 to the stage before, and the new state adds k_8
C = (
    (),
    (-14.155112264123755,),
    (-17.97296035885952, -2.859693295451294),
    (147.12150275711716, -1.41221402718213, 71.68940251302358),
    (165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306),
    (
        24.854864614690072,
        -3.0009227002832186,
        47.4931110020768,
        5.5814197821558125,
        -0.6610691825249471,
    ),
    (
        30.91273214028599,
        -3.1208243349937974,
        77.79954646070892,
        34.28646028294783,
        -19.097331116725623,
        -28.087943162872662,
    ),
    (
        37.80277123390563,
        -3.2571969029072276,
        112.26918849496327,
        66.9347231244047,
        -40.06618937091002,
        -54.66780262877968,
        -9.48861652309627,
    ),
)
NODES = (
    0.0,
    0.6358126895828704,
    0.4095798393397535,
    0.9769306725060716,
    0.4288403609558664,
    1.0,
    1.0,
    1.0,
)
D = (
    0.21193756319429014,
    -0.42387512638858027,
    -0.3384627126235924,
    1.8046452872882734,
    2.325825639765069,
    0.0,
    0.0,
    0.0,
)
# Dense output of order 4: y(s) = (1-s) y + s (y_new + (1-s) (K_1 + s (K_2 + s K_3))).
H = (
    (
        25.948786856663858,
        -2.5579724845846235,
        10.433815404888879,
        -2.3679251022685204,
        0.524948541321073,
        1.1241088310450404,
        0.4272876194431874,
        -0.17202221070155493,
    ),
    (
        -9.91568850695171,
        -0.9689944594115154,
        3.0438037242978453,
        -24.495224566215796,
        20.176138334709044,
        15.98066361424651,
        -6.789040303419874,
        -6.710236069923372,
    ),
    (
        11.419903575922262,
        2.8879645146136994,
        72.92137995996029,
        80.12511834622643,
        -52.072871366152654,
        -59.78993625266729,
        -0.15582684282751913,
        4.883087185713722,
    ),
)


def quadrature_weights():
    """Weights B with y_new - y = h sum_i B_i s_i where dy/dT = s depends on the others only.

    Such a row reads k_i/(gamma h) = s_i + sum_j (C_ij/h) k_j, hence B (1/gamma - C) = (A_8, 1).
    """
    weights = [*A[5], 1.0, 1.0, 1.0]
    for i in reversed(range(8)):
        later = sum(weights[j] * C[j][i] for j in range(i + 1, 8))
        weights[i] = GAMMA * (weights[i] + later)
    return tuple(weights)


ZERO = (0.0, 0.0, 0.0)
B = quadrature_weights()
DRIFT = sum(b * d for b, d in zip(B, D, strict=True))


@inlined
def plus(y, a, k):
    """y + a k for triples (x, v, psi)."""
    return y[0] + a * k[0], y[1] + a * k[1], y[2] + a * k[2]


@inlined
def times(a, k):
    """a k for a triple."""
    return a * k[0], a * k[1], a * k[2]


@inlined
def sum2(y, c, k1, k2):
    """y + sum_i c_i k_i for triples, here and below."""
    return plus(plus(y, c[0], k1), c[1], k2)


@inlined
def sum3(y, c, k1, k2, k3):
    return plus(sum2(y, c, k1, k2), c[2], k3)


@inlined
def sum4(y, c, k1, k2, k3, k4):
    return plus(sum3(y, c, k1, k2, k3), c[3], k4)


@inlined
def sum5(y, c, k1, k2, k3, k4, k5):
    return plus(sum4(y, c, k1, k2, k3, k4), c[4], k5)


@inlined
def sum6(y, c, k1, k2, k3, k4, k5, k6):
    return plus(sum5(y, c, k1, k2, k3, k4, k5), c[5], k6)


@inlined
def sum7(y, c, k1, k2, k3, k4, k5, k6, k7):
    return plus(sum6(y, c, k1, k2, k3, k4, k5, k6), c[6], k7)


@inlined
def dot(c, k1, k2, k3, k4, k5, k6, k7, k8):
    """sum_i c_i k_i for triples."""
    return plus(sum7(ZERO, c, k1, k2, k3, k4, k5, k6, k7), c[7], k8)


@inlined
def exponentials(u, law):
    """w = e**v and 1/w, and e = e**-psi where the law, a literal, has it."""
    w, w_inverse = exp_and_inverse(u[1])
    return w, w_inverse, (0.0 if law == SLIP else exp(-u[2]))


@inlined
def prepare(y, w, e, h, p):
    """What the first point y of a step fixes: the arrow matrix, and its pivot."""
    law, kappa, beta, eta0 = p
    f_v, f_psi = state_rate_partials(law, w, y[1], y[2], e)
    gamma_h = GAMMA * h
    m = eta0 * w
    kappa_w = kappa * w
    a_psi = gamma_h / (1.0 - gamma_h * f_psi)
    # -(eta0 w) d/dv of g/(eta0 w); at rest w is a constant (exp.py)
    diagonal = 1.0 + (y[0] - y[1] - beta * y[2] if y[1] > -LIMIT else 0.0)
    pivot = 1.0 / (m / gamma_h + diagonal + gamma_h * kappa_w + beta * a_psi * f_v)
    return w, m, gamma_h, kappa_w, f_v, a_psi, pivot


@inlined
def solve(r_x, r_v, r_psi, beta, start):
    """Solve the arrow matrix of `prepare` for this right-hand side."""
    _, _, gamma_h, kappa_w, s_v, a_psi, pivot = start
    k_v = pivot * (r_v + gamma_h * r_x - (beta * a_psi) * r_psi)
    return gamma_h * (r_x - kappa_w * k_v), k_v, a_psi * (r_psi + s_v * k_v)


@inlined
def on_manifold(y_new, v_start, m_end, beta, h):
    """y_new with v held on x - beta psi, and whether it is, where inertia is below rounding.

    Over a step in which w changes by orders of magnitude, J sees a deviation at its start and
    not at its end.
    """
    x, v, psi = y_new
    held = x - beta * psi
    negligible = m_end * max(1.0, abs(v - v_start)) < 1e-14 * h
    return (x, held if negligible else v, psi), negligible


@inlined
def stage(u, w, w_inverse, e, w_lp, rest, p, start):
    """Increment k of a stage at u, given rest = sum_j (C_ij/h) k_j + h d_i df/dT.

    p = (law, kappa, beta, eta0); start is what `prepare` gave.
    """
    law, kappa, beta, _ = p
    x, v, psi = u
    r_x = kappa * (w_lp - w) + rest[0]
    r_v = (x - v - beta * psi) * (start[0] * w_inverse) + start[1] * rest[1]
    r_psi = state_rate(law, w, v, psi, e) + rest[2]
    return solve(r_x, r_v, r_psi, beta, start)


@inlined
def works(u, w, w_lp, beta):
    """Powers per a sigma V0 beyond their mu0 part: of the load point, x w_lp; of friction."""
    return u[0] * w_lp, (u[1] + beta * u[2]) * w


@inlined
def step(y, w, e, w_lp, ramp, h, p):
    """One step of size h from y = (x, v, psi).

    Parameters
    ----------
    y, w, e : state, e**v and e**-psi at the start
    w_lp, ramp : load-point speed at the start and its rate d w_lp/dT
    p : (law, kappa, beta, eta0), law a literal where this is compiled

    Returns
    -------
    y_new, w_new, e_new : the state at the end
    error : its estimated error (triple)
    dense : the dense output's K_1, K_2, K_3 (triples)
    load_work, dissipation : integrals of `works` over the step
    """
    law, kappa, beta, eta0 = p
    start = prepare(y, w, e, h, p)
    r = 1.0 / h
    drift = h * kappa * ramp
    dw = h * ramp

    rest = (D[0] * drift, 0.0, 0.0)
    k1 = stage(y, w, 1.0 / w, e, w_lp, rest, p, start)
    p1, q1 = works(y, w, w_lp, beta)

    u = plus(y, A[1][0], k1)
    w_u, i_u, e_u = exponentials(u, law)
    w_l = w_lp + NODES[1] * dw
    rest = plus((D[1] * drift, 0.0, 0.0), r, times(C[1][0], k1))
    k2 = stage(u, w_u, i_u, e_u, w_l, rest, p, start)
    p2, q2 = works(u, w_u, w_l, beta)

    u = sum2(y, A[2], k1, k2)
    w_u, i_u, e_u = exponentials(u, law)
    w_l = w_lp + NODES[2] * dw
    rest = plus((D[2] * drift, 0.0, 0.0), r, sum2(ZERO, C[2], k1, k2))
    k3 = stage(u, w_u, i_u, e_u, w_l, rest, p, start)
    p3, q3 = works(u, w_u, w_l, beta)

    u = sum3(y, A[3], k1, k2, k3)
    w_u, i_u, e_u = exponentials(u, law)
    w_l = w_lp + NODES[3] * dw
    rest = plus((D[3] * drift, 0.0, 0.0), r, sum3(ZERO, C[3], k1, k2, k3))
    k4 = stage(u, w_u, i_u, e_u, w_l, rest, p, start)
    p4, q4 = works(u, w_u, w_l, beta)

    u = sum4(y, A[4], k1, k2, k3, k4)
    w_u, i_u, e_u = exponentials(u, law)
    w_l = w_lp + NODES[4] * dw
    rest = plus((D[4] * drift, 0.0, 0.0), r, sum4(ZERO, C[4], k1, k2, k3, k4))
    k5 = stage(u, w_u, i_u, e_u, w_l, rest, p, start)
    p5, q5 = works(u, w_u, w_l, beta)

    w_l = w_lp + dw
    u = sum5(y, A[5], k1, k2, k3, k4, k5)
    w_u, i_u, e_u = exponentials(u, law)
    rest = times(r, sum5(ZERO, C[5], k1, k2, k3, k4, k5))
    k6 = stage(u, w_u, i_u, e_u, w_l, rest, p, start)
    p6, q6 = works(u, w_u, w_l, beta)

    u = plus(u, 1.0, k6)
    w_u, i_u, e_u = exponentials(u, law)
    rest = times(r, sum6(ZERO, C[6], k1, k2, k3, k4, k5, k6))
    k7 = stage(u, w_u, i_u, e_u, w_l, rest, p, start)
    p7, q7 = works(u, w_u, w_l, beta)

    u = plus(u, 1.0, k7)
    w_u, i_u, e_u = exponentials(u, law)
    rest = times(r, sum7(ZERO, C[7], k1, k2, k3, k4, k5, k6, k7))
    k8 = stage(u, w_u, i_u, e_u, w_l, rest, p, start)
    p8, q8 = works(u, w_u, w_l, beta)

    free = plus(u, 1.0, k8)
    y_new, _ = on_manifold(free, y[1], eta0 * w_u, beta, h)
    error = (k8[0], k8[1] + (y_new[1] - free[1]), k8[2])
    w_new, _, e_new = exponentials(y_new, law)

    # The two quadratures: s_i = works(u_i) + gradient k_i + h d_i d/dT, weighted by B.
    k = dot(B, k1, k2, k3, k4, k5, k6, k7, k8)
    friction = y[1] + beta * y[2]
    load_work = w_lp * k[0] + DRIFT * dw * y[0]
    load_work += B[0] * p1 + B[1] * p2 + B[2] * p3 + B[3] * p4
    load_work += B[4] * p5 + B[5] * p6 + B[6] * p7 + B[7] * p8
    dissipation = w * ((1.0 + friction) * k[1] + beta * k[2])
    dissipation += B[0] * q1 + B[1] * q2 + B[2] * q3 + B[3] * q4
    dissipation += B[4] * q5 + B[5] * q6 + B[6] * q7 + B[7] * q8

    dense1 = dot(H[0], k1, k2, k3, k4, k5, k6, k7, k8)
    dense2 = dot(H[1], k1, k2, k3, k4, k5, k6, k7, k8)
    dense3 = dot(H[2], k1, k2, k3, k4, k5, k6, k7, k8)
    return y_new, w_new, e_new, error, dense1, dense2, dense3, h * load_work, h * dissipation
