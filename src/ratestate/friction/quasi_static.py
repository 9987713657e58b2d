"""Sliding without inertia (M = 0) in closed form: excursions and runaway.

With V0 := V_lp, v = ln(V/V_lp) and psi = ln(theta V_lp/Dc), the force balance without mass is
x = (tau - tau_ss)/(a sigma) = v + (b/a) psi, and the motion is plane.  Let kappa = K Dc/(a sigma)
and c = (b - a)/a, so that kappa = c at K = K_c_qs.  h(z) = exp(-z) - 1 + z is convex, and 0 only
at z = 0.

Aging law, y = v + psi = ln(V theta/Dc), time S with dS = dt/theta:

    dpsi/dS = 1 - exp(y),   dy/dS = kappa (exp(psi) - 1) - (kappa - c) (exp(y) - 1)
    E = kappa h(-psi) + h(-y),   dE/dS = -(kappa - c) (exp(y) - 1)^2

Slip law, slip D in units of Dc instead of time, z = x + kappa h(v):

    dx/dD = kappa (exp(-v) - 1),   dv/dD = z - (kappa - c) v
    E = -x - ln(1 - z),   dE/dD = -kappa (kappa - c) v (1 - exp(-v))/(1 - z)   if z < 1

E is the excursion: 0 in steady sliding and positive elsewhere.  It is conserved at K = K_c_qs,
falls above, and grows below.  Its level curves are closed, so that under the aging law every
motion at K_c_qs is periodic.  With X = x + E the level curves of the slip law are
E = kappa h(v) + h(X), as under the aging law.  (Both laws are the Lotka-Volterra equations there,
in the time S or the slip D.)  Starts with z >= 1 under the slip law lie beyond these curves: at
K_c_qs they run away, and V grows without bound in a finite time.  At any stiffness starts with
ln(V theta/Dc) >= K/K_c_qs run away too.

The edge of runaway under the slip law, with y = v + psi and e(v) = kappa (exp(-v) - 1):

    dv/dD = (b/a) y + e(v),   dy/dD = c y + e(v)

The distance Q = y - K/K_c_qs obeys dQ/dD = c Q + kappa exp(-v): once it is not negative, it and V
grow without bound.  At V >> V_lp the equations are linear, and while Q < 0 the motion turns back,
however fast it is.  So for K >= K_c_qs one path, along which Q rises to 0 as V grows, separates
runaway from return.  v rises all along this path, no motion returns and then runs away, and the
path meets each line of disturbances once.  It is integrated backwards from its fast end, as y(v),
because it attracts its neighbours in this direction.

Sources: Gu, Rice, Ruina & Tse (1984) doi:10.1016/0022-5096(84)90007-3 (slip law), Ranjith & Rice
(1999) doi:10.1016/S0022-5096(98)00113-6 (aging law).  Comments beside the bounds for K > K_c_qs
derive them.  Numbers are in SI, and their ranges are not checked.
"""

from typing import NamedTuple

import numpy as np

from ..errors import ParameterError, SolverError
from .closed_forms import K_c_qs, elementwise
from .laws import law_name

#: points of the trapezoidal rule round a cycle; a multiple of 4 keeps them off the axes
POINTS = 512
# ln(V/V_lp) above which exp(-v) is below rounding; the tolerance along the edge of runaway
LARGE_V, RTOL = 40.0, 1e-12


def excursion(V, theta, *, V_lp, a, b, Dc, sigma, K, law):
    """Return the excursion E, the distance of a motion without inertia from steady sliding.

    E is conserved at K = K_c_qs.  If K > K_c_qs it falls to 0, so that the motion approaches steady
    sliding.  Under the slip law this holds only if E is finite.  If K < K_c_qs, E grows without
    end.  Let v = ln(V/V_lp), psi = ln(V_lp theta/Dc), kappa = K Dc/(a sigma), x = v + (b/a) psi and
    h(z) = exp(-z) - 1 + z.  Then::

        E = kappa h(-psi) + h(-v - psi)               aging law
        E = -x - ln(1 - z),   z = x + kappa h(v)      slip law

    Parameters
    ----------
    V, theta : float, ndarray or DataArray
        Slip velocity [m/s] and state [s], > 0.
    V_lp : float, ndarray or DataArray
        Load-point velocity [m/s], which must stay constant.
    a, b, Dc, sigma, K : float, ndarray or DataArray
        Friction parameters [1, 1, m], normal stress [Pa], stiffness per area [Pa/m].
    law : str
        Friction law, slip or aging.

    Returns
    -------
    float, ndarray or DataArray
        E [1], >= 0.  Under the slip law E is inf if z >= 1.  Then V grows without bound if
        K <= K_c_qs, and may do so otherwise.

    Raises
    ------
    ParameterError
        If the law is unknown, or neither slip nor aging.

    Notes
    -----
    The rounding error is about 1e-15 (1 + E).  Under the slip law it may be larger: the rounding
    error of z divided by 1 - z.
    """
    kappa, v, psi = K * Dc / (a * sigma), np.log(V / V_lp), np.log(theta * V_lp / Dc)
    name = law_name(law)
    if name == "aging":
        return kappa * convex(-psi) + convex(-(v + psi))
    if name != "slip":
        raise ParameterError(
            "has no excursion", "Give 'slip' or 'aging'.", symbol="law", value=repr(law)
        )
    x = v + b / a * psi
    with np.errstate(divide="ignore"):
        return -x - np.log1p(-np.minimum(x + kappa * convex(v), 1.0))


@elementwise()
def period(E, *, V_lp, a, b, Dc):
    """Return the period of sliding without inertia at K = K_c_qs, slip or aging law.

    It is 2 pi/omega_c for small excursions (see `omega_c`) and grows with E.  The slip per cycle is
    V_lp times the period.

    Parameters
    ----------
    E : float, ndarray or DataArray
        Excursion [1], see `excursion`.  Up to 100 the period is accurate to 1e-9.  Values smaller
        than 1e-10, negative ones too, count as 1e-10.
    V_lp, a, b, Dc : float, ndarray or DataArray
        Load-point velocity [m/s], friction parameters [1, 1, m].

    Returns
    -------
    float, ndarray or DataArray
        Period [s]; inf if E is inf, else NaN if b <= a (K_c_qs does not exist) or E is NaN.
    """
    c = np.where(b > a, b / a - 1, np.nan)[..., None]
    # On c h(p) + h(q) = E, with sqrt(c h(p)) = sqrt(E) cos(phi) and sqrt(h(q)) = sqrt(E) sin(phi),
    # dq/dT = c (exp(-p) - 1) gives dT/dphi, smooth and periodic.  E has no effect below 1e-10.
    level = np.clip(E, 1e-10, 1e100)[..., None]
    phi = 2 * np.pi / POINTS * (np.arange(POINTS) + 0.5)
    cos, sin = np.cos(phi), np.sin(phi)
    p, q = inverse_convex(level * cos**2 / c, cos), inverse_convex(level * sin**2, sin)
    turn = 2 * level * cos * sin / (c * np.expm1(-p) * np.expm1(-q))
    return np.where(np.isinf(E), np.inf, 2 * np.pi * turn.mean(-1)) * Dc / V_lp


def runaway_step(*, a, b):
    """Return the smallest V_lp/V of a speed step after which V grows without bound.

    It is b/(b - a), for a step from steady sliding at V to V_lp, at K = K_c_qs, without inertia and
    under the slip law.  After smaller steps, and after all steps down, the motion is periodic.

    Parameters
    ----------
    a, b : float, ndarray or DataArray
        Direct and evolution effect [1].

    Returns
    -------
    float, ndarray or DataArray
        V_lp/V [1], in the shape that the arguments broadcast to; inf if b <= a.
    """
    with np.errstate(divide="ignore"):
        return 1 + a / np.maximum(b - a, 0.0)


@elementwise()
def runaway_step_lower_bound(*, a, b, Dc, sigma, K):
    """Return a V_lp/V below which no speed step leads to runaway (M = 0, slip law).

    It is the larger of 1 + r/c and exp(r^2/(r + c)), with r = K/K_c_qs and c = (b - a)/a.  At r = 1
    it equals `runaway_step`.  For r > 1 the smallest step to runaway has no closed form.

    Parameters
    ----------
    a, b, Dc, sigma, K : float, ndarray or DataArray
        Direct and evolution effect [1], critical slip distance [m], normal stress [Pa], stiffness
        per area [Pa/m].

    Returns
    -------
    float, ndarray or DataArray
        V_lp/V [1], in the shape that the arguments broadcast to; 1 if K < K_c_qs, inf if b <= a or
        beyond double precision.
    """
    # With s = c/(r + c) and u = x + c v, no path crosses u = (b/a) r (1 - s exp(-v)) upwards
    # while v grows.  A step starts at u = 0, v = -ln(V_lp/V): below this curve if V_lp/V < 1/s.
    # Also du/dv < b/a while v < 0, so u < (b/a) ln(V_lp/V) at v = 0.
    r, c = _stiffness_ratio(a, b, Dc, sigma, K)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        ratio = np.maximum(1 + r / c, np.exp(r / (1 + c / r)))
    return np.where(b > a, np.where(r < 1, 1.0, ratio), np.inf)


@elementwise()
def runaway_step_upper_bound(*, a, b, Dc, sigma, K):
    """Return a V_lp/V above which every speed step leads to runaway (M = 0, slip law).

    It is b/(b - a) + ((b/(b - a)) (r - 1) exp(1 + (b/a)(r - 1)))^(a/b), with r = K/K_c_qs.  At
    r = 1 it equals `runaway_step`.  It is finite, so some step leads to runaway at any stiffness.

    Parameters
    ----------
    a, b, Dc, sigma, K : float, ndarray or DataArray
        Direct and evolution effect [1], critical slip distance [m], normal stress [Pa], stiffness
        per area [Pa/m].

    Returns
    -------
    float, ndarray or DataArray
        V_lp/V [1], in the shape that the arguments broadcast to; 1 if K < K_c_qs, inf if b <= a or
        beyond double precision.
    """
    # While v < 0 < u the quantity (1 - x - c h(v)) exp(x) falls, from exp(cL) (b/a - c exp(L)) with
    # L = ln(V_lp/V), and at v = 0 it is (1 - x) exp(x).  Beyond v = 0 no path crosses
    # u = (b/a) r - c exp(-v) downwards, and above this curve V runs away.  So a step runs away if,
    # with P = (b/a) r - c, exp(cL) (c exp(L) - b/a) >= (P - 1) exp(P).  This ratio is sufficient
    # for that, and simpler.
    r, c = _stiffness_ratio(a, b, Dc, sigma, K)
    beta, excess = b / a, np.maximum(r - 1, 0.0)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        ratio = beta / c + (beta / c * excess) ** (1 / beta) * np.exp(1 / beta + excess)
    return np.where(b > a, np.where(r < 1, 1.0, ratio), np.inf)


def _stiffness_ratio(a, b, Dc, sigma, K):
    """Return K/K_c_qs and (b - a)/a; meaningless if b <= a."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return K / K_c_qs(a=a, b=b, Dc=Dc, sigma=sigma), (b - a) / a


def convex(z):
    """Return h(z) = exp(-z) - 1 + z, which is convex and near z^2/2 at small z."""
    return np.expm1(-z) + z


def inverse_convex(value, sign):
    """Return the z of this sign with h(z) = value > 0."""
    far = value + np.sqrt(2 * value)
    z = np.where(sign > 0, far, -np.log1p(far))  # Newton's method converges from beyond the root
    for _ in range(40):
        step = (convex(z) - value) / -np.expm1(-z)
        z = z - step
        if np.all(np.abs(step) <= 1e-15 * np.abs(z)):
            break
    return z


class Thresholds(NamedTuple):
    """Smallest disturbances that run away, dimensionless, > 0; inf above `largest`.

    step_up: ln(V_lp/V before); kick_up, kick_down: rise and fall of tau/(a sigma), both > 0.
    """

    step_up: float
    kick_up: float
    kick_down: float


def edge_of_slip_law(kappa, beta, largest):
    """Return the `Thresholds` of one slider without mass under the slip law.

    A step up starts at y = 0, v = -step.  A kick, which does not change the state, starts at y = v.
    SolverError if the path cannot be followed; kappa > beta - 1 > 0 is not checked.

    kappa, beta : float, K Dc/(a sigma) and b/a
    largest : float, largest disturbance to find
    """
    from scipy.integrate import solve_ivp  # slow to import

    c = beta - 1.0

    def slope(v, y):
        load = kappa * np.expm1(-v)
        return (c * y + load) / (beta * y + load)

    def step(v, y):
        return y[0]

    def kick(v, y):
        return y[0] - v

    kick.terminal = 2  # type: ignore[attr-defined]  # the second is the kick down, after the step
    fast = kappa / c - kappa * np.exp(-LARGE_V) / (c + kappa / c)
    path = solve_ivp(
        slope,
        (max(LARGE_V, largest), -largest),
        [fast],
        method="LSODA",
        events=(step, kick),
        rtol=RTOL,
        atol=RTOL / beta,
    )
    if not path.success:
        raise SolverError(
            f"the edge of runaway (M = 0) could not be followed: K Dc/(a sigma) = {kappa:.6g}, "
            f"b/a = {beta:.6g}: {path.message}"
        )
    steps, kicks = path.t_events
    sizes = -steps, kicks[(kicks > 0.0) & (kicks <= largest)], -kicks[kicks < 0.0]
    return Thresholds(*(float(x[0]) if x.size else np.inf for x in sizes))


#: law -> function that gives `Thresholds` of a slider without mass
EDGES = {
    "slip": edge_of_slip_law,
    # every motion returns (Ranjith & Rice 1999)
    "aging": lambda kappa, beta, largest: Thresholds(np.inf, np.inf, np.inf),
}
