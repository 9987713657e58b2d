"""Sliding without inertia (M = 0), in closed form: excursions from steady sliding and runaway.

With V0 := V_lp, v = ln(V/V_lp) and psi = ln(theta V_lp/Dc), the force balance without mass is
x = (tau - tau_ss)/(a sigma) = v + (b/a) psi, and the motion is plane.  Let kappa = K Dc/(a sigma),
c = (b - a)/a, so that kappa = c where K = K_c_qs, and h(z) = exp(-z) - 1 + z, which is convex and
0 at z = 0 only.

Aging law, y = v + psi = ln(V theta/Dc), time S with dS = dt/theta:

    dpsi/dS = 1 - exp(y),   dy/dS = kappa (exp(psi) - 1) - (kappa - c) (exp(y) - 1)
    E = kappa h(-psi) + h(-y),   dE/dS = -(kappa - c) (exp(y) - 1)^2

Slip law, slip D in units of Dc instead of time, z = x + kappa h(v):

    dx/dD = kappa (exp(-v) - 1),   dv/dD = z - (kappa - c) v
    E = -x - ln(1 - z),   dE/dD = -kappa (kappa - c) v (1 - exp(-v))/(1 - z)   where z < 1

E is the excursion: 0 in steady sliding, positive elsewhere, conserved at K = K_c_qs, falling
above, growing below.  Its level curves are closed, so that at K_c_qs every start of the aging law
is periodic; with X = x + E those of the slip law are E = kappa h(v) + h(X), the same curves.
(Both laws are the Lotka-Volterra equations there, in the time S or the slip D.)  Starts of the
slip law with z >= 1 lie on no such curve: at K_c_qs they run away, V growing without bound in a
finite time.  At any stiffness so do those with ln(V theta/Dc) >= K/K_c_qs.

Sources: Gu, Rice, Ruina & Tse (1984) doi:10.1016/0022-5096(84)90007-3 (slip law), Ranjith & Rice
(1999) doi:10.1016/S0022-5096(98)00113-6 (aging law).  The bounds for K > K_c_qs
are derived in the comments beside them.  Numbers are in SI, and their ranges are not checked.
"""

import numpy as np

from ..errors import ParameterError
from .convex import inverse_convex
from .elementwise import elementwise
from .laws import LAWS, friction_law
from .stability import K_c_qs

#: points of the trapezoidal rule round a cycle; a multiple of 4 keeps them off the axes
POINTS = 512


def excursion(V, theta, *, V_lp, a, b, Dc, sigma, K, law):
    """How far a state without inertia is from steady sliding: E of this module [1], >= 0.

    Conserved at K = K_c_qs; where K > K_c_qs it falls to 0, so that steady sliding is approached
    from everywhere (aging law) or from wherever it is finite (slip law); where K < K_c_qs it
    grows without end.

    Parameters
    ----------
    V, theta : float, array or DataArray
        Slip velocity [m/s] and state [s], > 0.
    V_lp : float, array or DataArray
        Load-point velocity [m/s], constant from now on.
    a, b, Dc, sigma, K : float, array or DataArray
        Friction parameters [1, 1, m], normal stress [Pa], stiffness per area [Pa/m].
    law : str
        Friction law, one that knows its excursion in closed form.

    Returns
    -------
    float, array or DataArray
        E [1], with rounding errors of about 1e-15 (1 + E), or that of z over 1 - z.  With the
        slip law inf from the separatrix on: then V runs away if K <= K_c_qs, and may if not.

    Raises
    ------
    ParameterError
        Unknown law, or one that does not know it.
    """
    friction = friction_law(law)
    if not friction.gives("excursion"):
        known = " and ".join(repr(name) for name, one in LAWS.items() if one.gives("excursion"))
        raise ParameterError(f"law = {law!r}: excursion knows {known} only")
    v, psi = np.log(V / V_lp), np.log(theta * V_lp / Dc)
    return friction.excursion(v, psi, K * Dc / (a * sigma), b / a)


@elementwise()
def period(E, *, V_lp, a, b, Dc):
    """Period [s] of sliding without inertia at K = K_c_qs, the same for laws of one length.

    2 pi/omega_c for small excursions, growing with E; V_lp times it is the slip per cycle.

    Parameters
    ----------
    E : float, array or DataArray
        Excursion [1], see `excursion`; up to 100 the period is good to 1e-9.  Below 1e-10 it is
        taken as that, negative ones too.
    V_lp, a, b, Dc : float, array or DataArray
        Load-point velocity [m/s], friction parameters [1, 1, m].

    Returns
    -------
    float, array or DataArray
        Period [s]; inf where E is, else NaN where b <= a (there is no K_c_qs) or E is NaN.
    """
    c = np.where(b > a, b / a - 1, np.nan)[..., None]
    # On c h(p) + h(q) = E, run through by sqrt(c h(p)) = sqrt(E) cos(phi) and so on:
    # dq/dT = c (exp(-p) - 1) gives dT/dphi, smooth and periodic.  Below 1e-10 E plays no part.
    level = np.clip(E, 1e-10, 1e100)[..., None]
    phi = 2 * np.pi / POINTS * (np.arange(POINTS) + 0.5)
    cos, sin = np.cos(phi), np.sin(phi)
    p, q = inverse_convex(level * cos**2 / c, cos), inverse_convex(level * sin**2, sin)
    turn = 2 * level * cos * sin / (c * np.expm1(-p) * np.expm1(-q))
    return np.where(np.isinf(E), np.inf, 2 * np.pi * turn.mean(-1)) * Dc / V_lp


def runaway_step(*, a, b):
    """Smallest V_lp/V, new speed over old, at which a step runs away: b/(b - a).

    At K = K_c_qs, without inertia, by the slip law.

    Steady sliding at V, and then at once V_lp: x + c h(v) = c (V_lp/V - 1) >= 1.  Smaller steps,
    and all steps down, are periodic.

    Parameters
    ----------
    a, b : float, array or DataArray
        Direct and evolution effect [1].

    Returns
    -------
    float, array or DataArray
        V_lp/V [1], in the shape that the arguments broadcast to; inf where b <= a.
    """
    with np.errstate(divide="ignore"):
        return 1 + a / np.maximum(b - a, 0.0)


@elementwise()
def runaway_step_lower_bound(*, a, b, Dc, sigma, K):
    """Ratio V_lp/V below which no step in V_lp runs away at M = 0 with the slip law [1].

    With r = K/K_c_qs and c = (b - a)/a the larger of 1 + r/c and exp(r^2/(r + c)): a lower bound
    of the ratio that does, which for r > 1 is no closed form; at r = 1 it is `runaway_step`.

    Parameters
    ----------
    a, b, Dc, sigma, K : float, array or DataArray
        Direct and evolution effect [1], critical slip distance [m], normal stress [Pa], stiffness
        per area [Pa/m].

    Returns
    -------
    float, array or DataArray
        V_lp/V, in the shape that the arguments broadcast to; 1 where K < K_c_qs, inf where b <= a.
    """
    # Where s = c/(r + c), no path crosses u = (b/a) r (1 - s exp(-v)), u = x + c v, upwards
    # while v grows; a step starts at u = 0, v = -ln(V_lp/V), that is, below it if V_lp/V < 1/s.
    # Also du/dv < b/a while v < 0, so that u < (b/a) ln(V_lp/V) at v = 0.
    r, c = _stiffness_ratio(a, b, Dc, sigma, K)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        ratio = np.maximum(1 + r / c, np.exp(r / (1 + c / r)))
    return np.where(b > a, np.where(r < 1, 1.0, ratio), np.inf)


@elementwise()
def runaway_step_upper_bound(*, a, b, Dc, sigma, K):
    """Ratio V_lp/V from which every step in V_lp runs away at M = 0 with the slip law [1].

    b/(b - a) + ((b/(b - a)) (r - 1) exp(1 + (b/a)(r - 1)))^(a/b) with r = K/K_c_qs: an upper
    bound of the ratio that does; at r = 1 it is `runaway_step`.  However stiff the spring, then,
    some step runs away.

    Parameters
    ----------
    a, b, Dc, sigma, K : float, array or DataArray
        Direct and evolution effect [1], critical slip distance [m], normal stress [Pa], stiffness
        per area [Pa/m].

    Returns
    -------
    float, array or DataArray
        V_lp/V, in the shape that the arguments broadcast to; 1 where K < K_c_qs, inf where b <= a.
    """
    # While v < 0 < u the quantity (1 - x - c h(v)) exp(x) falls, from exp(cL) (b/a - c exp(L)) with
    # L = ln(V_lp/V), and at v = 0 it is (1 - x) exp(x).  Beyond v = 0 no path crosses
    # u = (b/a) r - c exp(-v) downwards, where V runs away.  So it does if, with P = (b/a) r - c,
    # exp(cL) (c exp(L) - b/a) >= (P - 1) exp(P), to which this ratio is a simpler sufficient one.
    r, c = _stiffness_ratio(a, b, Dc, sigma, K)
    beta, excess = b / a, np.maximum(r - 1, 0.0)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        ratio = beta / c + (beta / c * excess) ** (1 / beta) * np.exp(1 / beta + excess)
    return np.where(b > a, np.where(r < 1, 1.0, ratio), np.inf)


def _stiffness_ratio(a, b, Dc, sigma, K):
    """K/K_c_qs and (b - a)/a; meaningless where b <= a."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return K / K_c_qs(a=a, b=b, Dc=Dc, sigma=sigma), (b - a) / a
