"""Steady sliding and its stability: closed forms (eqs 5-7, 10) and eigenvalues.

Functions of parameters take floats, NumPy arrays and named DataArrays in SI units, and do not check
ranges.  V_c is 0 if sliding is unstable at any speed, and inf if it is stable at any speed.

Sources: Rice & Ruina (1983) doi:10.1115/1.3167042, Gu et al. (1984)
doi:10.1016/0022-5096(84)90007-3; equation numbers follow Im, Marone & Elsworth (2019).
"""

import functools
import inspect

import numpy as np

from .roots import polynomial_roots

# Largest K/K_c_qs - 1 that rounding may cause.
ROUNDING = 1e-15
#: relative distance from K_c within which a slider is neither stable nor unstable
EDGE_WIDTH = 1e-8


def elementwise(*dims):
    """Make a function of arrays take floats and DataArrays too (`call_elementwise`)."""

    def decorate(function):
        signature = inspect.signature(function)

        @functools.wraps(function)
        def call(*args, **kwargs):
            return call_elementwise(function, signature.bind(*args, **kwargs).arguments, *dims)

        return call

    return decorate


def call_elementwise(function, given, *dims):
    """Call a function of NumPy arrays with floats, arrays or DataArrays by name.

    All arguments are broadcast to one shape.  The result is a DataArray if an argument is one, else
    an array, or a NumPy number for shape ().

    dims : names of the dimensions that the function adds at the end
    """

    def call(*arrays):
        broadcast = np.broadcast_arrays(*arrays)
        return function(**dict(zip(given, broadcast, strict=True)))

    if any(hasattr(value, "dims") for value in given.values()):
        import xarray

        return xarray.apply_ufunc(call, *given.values(), output_core_dims=[dims])
    return call(*(np.asarray(value, float) for value in given.values()))[()]


def eta(V, *, a, Dc, sigma, M):
    """Return the dynamic instability coefficient M V^2/(sigma a Dc) (eq. 7).

    Parameters
    ----------
    V : float, ndarray or DataArray
        Slip velocity [m/s].
    a, Dc, sigma, M : float, ndarray or DataArray
        Direct effect [1], critical slip distance [m], normal stress [Pa], mass per area [kg/m^2].

    Returns
    -------
    float, ndarray or DataArray
        eta [1], in the shape that the arguments broadcast to.
    """
    return M * V**2 / (sigma * a * Dc)


def K_c_qs(*, a, b, Dc, sigma):
    """Return the critical stiffness without inertia, (b - a) sigma/Dc.

    Parameters
    ----------
    a, b, Dc, sigma : float, array or DataArray
        Direct and evolution effect [1], critical slip distance [m], normal stress [Pa].

    Returns
    -------
    float, array or DataArray
        K_c_qs [Pa/m], in the shape that the arguments broadcast to; negative if b < a.
    """
    return (b - a) * sigma / Dc


def K_c(V, *, a, b, Dc, sigma, M):
    """Return the critical stiffness for sliding at V (eq. 6).

    K_c = K_c_qs (1 + eta), for the slip or aging law.  Steady sliding is unstable if K < K_c.

    Parameters
    ----------
    V : float, ndarray or DataArray
        Slip velocity [m/s].
    a, b, Dc, sigma, M : float, ndarray or DataArray
        Direct and evolution effect [1], critical slip distance [m], normal stress [Pa], mass
        per area [kg/m^2].

    Returns
    -------
    float, ndarray or DataArray
        K_c [Pa/m], in the shape that the arguments broadcast to; negative if b < a.
    """
    return K_c_qs(a=a, b=b, Dc=Dc, sigma=sigma) * (1 + eta(V, a=a, Dc=Dc, sigma=sigma, M=M))


def b_of_K_c(V, critical, *, a, Dc, sigma, M):
    """Return the b [1] at which K_c at V [m/s] equals `critical` [Pa/m] (eq. 6)."""
    return a + critical * Dc / sigma / (1 + eta(V, a=a, Dc=Dc, sigma=sigma, M=M))


def a_of_K_c(V, critical, *, b, Dc, sigma, M):
    """Return the a > 0 [1] at which K_c at V [m/s] equals `critical` [Pa/m] (eq. 6).

    It is the positive root, an ndarray, of a^2 - (b - h - r) a - b h, with h = M V^2/(sigma Dc) and
    r = critical Dc/sigma.  M > 0 and b > 0 are not checked, and DataArrays are not accepted.
    """
    h, r = M * V**2 / (sigma * Dc), critical * Dc / sigma
    half = 0.5 * (b - h - r)
    root = np.hypot(half, np.sqrt(b * h))
    # the form of the root without cancellation
    return np.where(half > 0.0, half + root, b * h / np.maximum(root - half, 1e-300))


def K_c_of_any_law(V, *, Dc, M, dtau_ss_dV, dtau_dV):
    """Return the critical stiffness of any law with one slip distance (eq. 5).

    Parameters
    ----------
    V, Dc, M : float, ndarray or DataArray
        Speed [m/s], critical slip distance [m], mass per area [kg/m^2].
    dtau_ss_dV, dtau_dV : float, ndarray or DataArray
        Slope of the steady-state stress, and of the stress at constant state [Pa s/m], at V.

    Returns
    -------
    float, ndarray or DataArray
        K_c [Pa/m], in the shape that the arguments broadcast to; negative if dtau_ss_dV > 0.
    """
    return -V * dtau_ss_dV / Dc * (1 + M * V / (Dc * dtau_dV))


@elementwise()
def V_c(*, a, b, Dc, sigma, K, M):
    """Return the critical velocity (eq. 10): steady sliding at V > V_c is unstable.

    Parameters
    ----------
    a, b, Dc, sigma, K, M : float, ndarray or DataArray
        Direct and evolution effect [1], critical slip distance [m], normal stress [Pa], stiffness
        per area [Pa/m], mass per area [kg/m^2].

    Returns
    -------
    float, ndarray or DataArray
        V_c [m/s], in the shape that the arguments broadcast to.  It is 0 if sliding is
        unstable at any speed (K <= K_c_qs, to rounding).  It is inf if sliding is stable at any
        speed (b <= a, K = inf, or M = 0 with K > K_c_qs).
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        excess = K * Dc / ((b - a) * sigma) - 1
        critical = np.where(excess > ROUNDING, np.sqrt(sigma * a * Dc / M * np.abs(excess)), 0.0)
    return np.where(b > a, critical, np.inf)


@elementwise()
def f_n(*, K, M):
    """Return the natural frequency sqrt(K/M)/(2 pi) of the slider on its spring.

    Parameters
    ----------
    K, M : float, ndarray or DataArray
        Stiffness [Pa/m] and mass [kg/m^2] per area.

    Returns
    -------
    float, ndarray or DataArray
        f_n [Hz], in the shape that the arguments broadcast to; inf if M = 0 or K = inf.
    """
    with np.errstate(divide="ignore"):
        return np.sqrt(K / M) / (2 * np.pi)


@elementwise()
def omega_c(V, *, a, b, Dc):
    """Return the angular frequency at the Hopf bifurcation, (V/Dc) sqrt((b - a)/a).

    Parameters
    ----------
    V : float, ndarray or DataArray
        Slip velocity [m/s].
    a, b, Dc : float, ndarray or DataArray
        Direct and evolution effect [1], critical slip distance [m].

    Returns
    -------
    float, ndarray or DataArray
        omega_c [rad/s], in the shape that the arguments broadcast to.  It does not depend on the
        mass.  It is NaN if b <= a, because there is no bifurcation.
    """
    return V / Dc * np.sqrt(np.where(b > a, (b - a) / a, np.nan))


@elementwise("mode")
def eigenvalues(V, *, a, b, Dc, sigma, K, M):
    """Return the eigenvalues of steady sliding at V under the slip or aging law.

    Parameters
    ----------
    V : float, ndarray or DataArray
        Slip velocity [m/s].
    a, b, Dc, sigma, K, M : float, ndarray or DataArray
        Direct and evolution effect [1], critical slip distance [m], normal stress [Pa], stiffness
        per area [Pa/m], mass per area [kg/m^2].

    Returns
    -------
    complex array or DataArray
        Eigenvalues [1/s], least stable first, along a last dimension "mode" of size 3.  Modes that
        decay infinitely fast are -inf.  If M = 0 there is one.  If K = inf there are two, and the
        third is -V/Dc, because only the state evolves.
    """
    inertia, kappa = eta(V, a=a, Dc=Dc, sigma=sigma, M=M), K * Dc / (a * sigma)
    margin = (K - K_c(V, a=a, b=b, Dc=Dc, sigma=sigma, M=M)) * Dc / (a * sigma)
    modes = steady_modes(inertia, kappa, b / a, margin)
    rate = (V / Dc)[..., None]
    modes.real, modes.imag = modes.real * rate, modes.imag * rate  # -inf times a complex is nan
    return modes


def steady_modes(eta, kappa, beta, margin):
    """Return the eigenvalues [V/Dc] of small perturbations of steady sliding.

    The force balance (eq. 4) with either evolution law, linearised at theta = Dc/V:

        eta L^3 + (1 + eta) L^2 + (1 - beta + kappa) L + kappa = 0

    The last axis of the complex array has the three eigenvalues by descending real part, with the
    positive imaginary part of a conjugate pair first.  Each is accurate to a few units in the last
    place of its modulus unless it is nearly a double root.  If eta = 0 the last one is -inf, and if
    kappa = inf the last two are.  Ranges are not checked.

    ======  =======================================================================
    eta     M V^2/(sigma a Dc) (eq. 7), >= 0
    kappa   K Dc/(a sigma), > 0; if it is inf, the margin is not used
    beta    b/a
    margin  (K - K_c) Dc/(a sigma) = kappa - (beta - 1)(1 + eta), given by the caller: the growth
            rate has as many correct digits as the margin
    ======  =======================================================================
    """
    rigid = np.isinf(kappa)
    kappa = np.where(rigid, 1.0, kappa)
    rho = _isolated_root(eta, kappa, beta)
    # With L = -rho/eta known, the other two solve L^2 + p L + q = 0.  This form of p has no
    # cancellation except in the margin, so the growth rate has the right sign despite rounding.
    p = margin * rho / ((1 + eta) * rho**2 + kappa * eta**2)
    q = kappa / rho
    half, discriminant = -p / 2, p**2 / 4 - q
    root = np.sqrt(np.abs(discriminant))
    is_pair = discriminant < 0
    outer = half + np.copysign(root, half)
    modes = np.empty((*np.shape(rho), 3), complex)
    with np.errstate(divide="ignore"):
        real = [np.where(is_pair, half, outer), np.where(is_pair, half, q / outer), -rho / eta]
    modes.real = np.stack(real, -1)
    modes.imag = np.where(is_pair, root, 0.0)[..., None] * [1, -1, 0]
    order = np.argsort(-modes.real, axis=-1, kind="stable")
    modes = np.take_along_axis(modes, order, -1)
    modes[rigid] = [-1.0, -np.inf, -np.inf]
    return modes


def _isolated_root(eta, kappa, beta):
    """Return the root of x^3 - (1+eta) x^2 + eta (kappa+1-beta) x - eta^2 kappa.

    A positive root exists, as the sign changes between 0 and infinity.  The function returns the
    root farthest from the mean of all roots: if all three are real, it cannot be a double root, and
    a single real root is farther from the mean than the others too.  At eta = 0 the double root at
    x = 0 is the pair of the quasi-static system, and the function returns x = 1.
    """
    c = np.broadcast_arrays(1.0, -(1 + eta), eta * (kappa + 1 - beta), -(eta**2) * kappa)
    x = polynomial_roots(np.stack(c, axis=-1)).real
    farthest = np.abs(x - x.mean(axis=-1, keepdims=True)).argmax(axis=-1)
    return np.take_along_axis(x, farthest[..., None], axis=-1)[..., 0]
