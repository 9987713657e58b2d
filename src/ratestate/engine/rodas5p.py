"""One step of Rodas5P: Rosenbrock, 8 stages, order 5(4), stiffly accurate.

As published by Steinebach (2023), BIT Numer. Math. 63, 27, doi:10.1007/s10543-023-00967-x, in the
transformed form of Hairer & Wanner (1996, IV.7):

    (1/(gamma h) - J) k_i = f(T + c_i h, y + sum_j A_ij k_j) + sum_j (C_ij/h) k_j + h d_i df/dT
    y_new = y + sum_j A_8j k_j + k_8,      error estimate = k_8.

`model` has the equations: y = (x, v, psi), with one psi for each state of the law.  The
code makes use of their structure in two ways.

* J is an arrow (x and each psi are coupled to v alone), so one scalar pivot solves each stage.
* The v row is multiplied by m = eta0 w(v at the start), which turns dv/dT = g/(eta0 w) into
  m dv/dT = g w_start/w.  Nothing overflows as V -> 0, and eta0 = 0 is a regular case: the row
  then reads S_v k_v = k_x - S_psi k_psi, and a linearly implicit method keeps x = S(v, psi).
  The result is the same method in the other variables, so the quasi-static limit needs no code of
  its own.  (If slip may reverse, c replaces w and omega replaces v: `point`.)

The step also integrates the work of the load point and the frictional dissipation, with the weights
`B` that the method implies for a pure quadrature.
"""

from ..friction.functions import larger, where
from ..friction.point import Point
from ..friction.tuples import dot_onto, minus_dot, plus, plus_sum, product, sum_of, times, total

GAMMA = 0.21193756319429014
# fmt: off
A6 = (
    -7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256,
    0.030198172008377946,
)
A = (
    (),
    (3.0,),
    (2.849394379747939, 0.45842242204463923),
    (-6.954028509809101, 2.489845061869568, -10.358996098473584),
    (2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641),
    A6,
    (*A6, 1.0),
    (*A6, 1.0, 1.0),
    (*A6, 1.0, 1.0, 1.0),  # the new state
)
C = (
    (),
    (-14.155112264123755,),
    (-17.97296035885952, -2.859693295451294),
    (147.12150275711716, -1.41221402718213, 71.68940251302358),
    (165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306),
    (24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125,
     -0.6610691825249471),
    (30.91273214028599, -3.1208243349937974, 77.79954646070892, 34.28646028294783,
     -19.097331116725623, -28.087943162872662),
    (37.80277123390563, -3.2571969029072276, 112.26918849496327, 66.9347231244047,
     -40.06618937091002, -54.66780262877968, -9.48861652309627),
)
NODES = (
    0.0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1.0, 1.0,
    1.0,
)
D = (
    0.21193756319429014, -0.42387512638858027, -0.3384627126235924, 1.8046452872882734,
    2.325825639765069, 0.0, 0.0, 0.0,
)
# Dense output of order 4: y(s) = (1-s) y + s (y_new + (1-s) (K_1 + s (K_2 + s K_3))).
H = (
    (25.948786856663858, -2.5579724845846235, 10.433815404888879, -2.3679251022685204,
     0.524948541321073, 1.1241088310450404, 0.4272876194431874, -0.17202221070155493),
    (-9.91568850695171, -0.9689944594115154, 3.0438037242978453, -24.495224566215796,
     20.176138334709044, 15.98066361424651, -6.789040303419874, -6.710236069923372),
    (11.419903575922262, 2.8879645146136994, 72.92137995996029, 80.12511834622643,
     -52.072871366152654, -59.78993625266729, -0.15582684282751913, 4.883087185713722),
)
# fmt: on


def quadrature_weights():
    """Return the weights of a quadrature: B with y_new - y = h sum_i B_i s_i.

    Here the rate s = dy/dT does not depend on y.  The row of y reads k_i/(gamma h) = s_i +
    sum_j (C_ij/h) k_j, hence B (1/gamma - C) = (A_8, 1).
    """
    weights = [*A[8]]
    for i in reversed(range(8)):
        later = sum(weights[j] * C[j][i] for j in range(i + 1, 8))
        weights[i] = GAMMA * (weights[i] + later)
    return tuple(weights)


B = quadrature_weights()
DRIFT = sum(b * d for b, d in zip(B, D, strict=True))


class Arrow:
    """The matrix of a step of size h from the point `at`, in x, omega and psi."""

    def __init__(self, at, h):
        self.at, self.m, self.gamma_h = at, at.m, GAMMA * h
        self.f_v, f_psi = at.f_slopes
        self.kappa_c, self.a_psi = at.kappa * at.c, psi_pivots(self.gamma_h, f_psi)
        diagonal, *self.g_psi = at.derived("inertia_slopes", q=1.0, m=at.m)  # slopes of -m dv/dT
        diagonal = at.m / self.gamma_h + diagonal + self.gamma_h * self.kappa_c
        self.pivot = 1.0 / dot_onto(diagonal, product(self.g_psi, self.a_psi), self.f_v)

    def solve(self, r):
        """Return the k, in x, v and psi, that solves the system for a right-hand side."""
        r_v = dot_onto(r[1], times(self.m, self.at.omega_by_psi), r[2:])
        r_v = minus_dot(r_v + self.gamma_h * r[0], product(self.g_psi, self.a_psi), r[2:])
        k_omega = self.pivot * r_v
        k_psi = product(self.a_psi, plus(r[2:], times(k_omega, self.f_v)))
        return self.at.in_v((self.gamma_h * (r[0] - self.kappa_c * k_omega), k_omega, *k_psi))


def psi_pivots(gamma_h, f_psi):
    """Return the inverse of the arrow's diagonal elements that belong to psi."""
    return tuple(gamma_h / (1.0 - gamma_h * slope) for slope in f_psi)


def drift_of(start, h, ramp):
    """Return h d/dT of dx/dT, m dv/dT and d psi/dT at constant state, each a tuple.

    The load point accelerates.  The drifts of v and psi are () unless normal stress varies.
    """
    psi = times(h, start.f_drift)
    of_v = times(-h, start.N_drift)
    of_v = tuple(minus_dot(column, times(start.m, start.omega_by_psi), psi) for column in of_v)
    return (h * start.kappa * ramp,), of_v, psi


def with_drift(rest, drift, d):
    """Return rest + d drift of each number, or rest without drift."""
    return plus(rest, times(d, drift)) if drift else rest


def stage_start(y, k):
    """Return the state u of the stage after the increments k, and sum_j C_ij k_j."""
    i = len(k)
    return plus_sum(y, A[i], k), sum_of(C[i], k) if k else (0.0,) * len(y)


def stages(arrow, h, w_lp, ramp=None):
    """Yield the point, w_lp and the increments so far, for each of the eight stages.

    w_lp, ramp : load-point speed at the start and its rate d w_lp/dT; None if the speed is constant
    """
    start = arrow.at
    k: tuple = ()
    of_x, of_v, of_psi = ((), (), ()) if ramp is None else drift_of(start, h, ramp)
    for node, d in zip(NODES, D, strict=True):
        u, c = stage_start(start.y, k)
        at = start.at(u, node * h) if k else start
        w_lp_here = w_lp if ramp is None else w_lp + node * (h * ramp)
        x, v, *psi = times(1.0 / h, c)
        r_v = total((at.g * (start.c * at.c_inverse) + start.m * v, *times(d, of_v)))
        r_v = minus_dot(r_v, times(start.m, at.omega_by_psi), at.f)
        r_x = at.x_rate(w_lp_here) + total((x, *times(d, of_x)))
        k = *k, arrow.solve((r_x, r_v, *plus(at.f, with_drift(psi, of_psi, d))))
        yield at, w_lp_here, k


def end_of_step(start, k, last, h):
    """Return the point at the end, whether v is held there, the error, dense output.

    If inertia is below rounding (m = eta0 c), v is held at the value at which friction balances the
    spring.  The method alone does not keep this balance if c changes by orders of magnitude over
    the step, because J is evaluated at the start.

    k : the eight increments; last : the point of the last stage
    """
    y = plus_sum(start.y, A[8], k)
    end = Point(last.law, last.p, y, last.w, last.e, None, last.kappa, last.eta0)
    is_slaved = end.m * larger(1.0, abs(y[1] - start.v)) < 1e-14 * h
    v = where(is_slaved, y[1] + end.g / end.S_slopes[0], y[1])
    new = start.at((y[0], v, *y[2:]), h)
    error = (k[7][0], k[7][1] + (v - y[1]), *k[7][2:])
    return new, is_slaved, error, dense_output(start.y, new.y, *(sum_of(row, k) for row in H))


def dense_output(y0, y1, k1, k2, k3):
    """Return each variable's polynomial in the fraction of the step, constant first.

    y0, y1 : the state at the ends of the step; k1, k2, k3 : K_1, K_2, K_3 of `H`
    """
    terms = zip(y0, y1, k1, k2, k3, strict=True)
    return tuple((u0, (u1 - u0) + a, b - a, c - b, -c) for u0, u1, a, b, c in terms)


def step(start, w_lp, ramp, h):
    """Take one step of size h.

    Parameters
    ----------
    start : the slider at the start, a `Point`
    w_lp, ramp : load-point speed at the start and its rate d w_lp/dT

    Returns
    -------
    new : the slider at the end
    error : estimated error of y (tuple)
    dense : the dense output
    load_work, dissipation : integrals of `Point.work_rates` over the step
    """
    points = [*stages(Arrow(start, h), h, w_lp, ramp)]
    last, _, k = points[-1]
    new, _, error, dense = end_of_step(start, k, last, h)

    # Both quadratures: powers_i = works(u_i) + gradient k_i + h_i d_i d/dT, weighted by B.
    powers = [at.work_rates(w_lp_here) for at, w_lp_here, _ in points]
    dy, (S_v, *S_psi) = start.in_omega(sum_of(B, k)), start.S_slopes
    load_1, friction_1 = sum_of(B[:4], powers[:4])
    load_2, friction_2 = sum_of(B[4:], powers[4:])
    load_work = w_lp * dy[0] + DRIFT * (h * ramp) * start.x + load_1 + load_2
    gradient = start.w * dot_onto(S_v * dy[1], S_psi, dy[2:]) + start.S * (start.c * dy[1])
    of_drift = times(DRIFT * h * start.w, start.N_drift)
    dissipation = total((gradient, *of_drift)) + friction_1 + friction_2
    return new, error, dense, h * load_work, h * dissipation
