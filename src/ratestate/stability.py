"""Steady sliding and its stability: closed forms (eqs 5-7, 10) and eigenvalues.

The functions of parameters serve floats, NumPy arrays and named DataArrays, in SI units.
Limits carry meaning: V_c is 0 where sliding is unstable at any speed, inf where at none.

Sources: Rice & Ruina (1983) doi:10.1115/1.3167042, Gu et al. (1984)
doi:10.1016/0022-5096(84)90007-3; equation numbers are those of Im, Marone & Elsworth (2019).
"""

import numpy as np

from .arrays import check_aligned
from .errors import ParameterError
from .modes import steady_modes
from .quantities import attrs
from .units import is_array, to_si


def eta(V, *, a, Dc, sigma, M):
    """Dynamic instability coefficient M V^2/(sigma a Dc) [1] for sliding at V [m/s] (eq. 7)."""
    return M * V**2 / (sigma * a * Dc)


def K_c_qs(*, a, b, Dc, sigma):
    """Critical stiffness [Pa/m] without inertia, (b - a) sigma/Dc; negative where b < a."""
    return (b - a) * sigma / Dc


def K_c(V, *, a, b, Dc, sigma, M):
    """Critical stiffness [Pa/m] for sliding at V [m/s] (eq. 6): unstable where K < K_c."""
    return K_c_qs(a=a, b=b, Dc=Dc, sigma=sigma) * (1 + eta(V, a=a, Dc=Dc, sigma=sigma, M=M))


def K_c_of_any_law(V, *, Dc, M, dtau_ss_dV, dtau_dV):
    """Critical stiffness [Pa/m] from the slopes of any friction law with one length Dc (eq. 5).

    Parameters
    ----------
    V, Dc, M : float, array or DataArray
        Speed [m/s], critical slip distance [m], mass per area [kg/m^2].
    dtau_ss_dV, dtau_dV : float, array or DataArray
        Slope of the steady-state stress, and of the stress at constant state [Pa s/m], at V.
    """
    return -V * dtau_ss_dV / Dc * (1 + M * V / (Dc * dtau_dV))


def V_c(*, a, b, Dc, sigma, K, M):
    """Critical velocity [m/s] (eq. 10): steady sliding at V > V_c is unstable.

    0 where sliding is unstable at any speed (K <= K_c_qs), inf where at none (b <= a, K = inf,
    or M = 0 with K > K_c_qs).
    """
    return _elementwise(_V_c, a, b, Dc, sigma, K, M)


def _V_c(a, b, Dc, sigma, K, M):
    with np.errstate(divide="ignore", invalid="ignore"):
        excess = K * Dc / ((b - a) * sigma) - 1
        critical = np.where(excess > 0, np.sqrt(sigma * a * Dc / M * np.abs(excess)), 0.0)
    return np.where(b > a, critical, np.inf)


def f_n(*, K, M):
    """Natural frequency sqrt(K/M)/(2 pi) [Hz]; inf, which is to say none, if M = 0 or K = inf."""
    return _elementwise(_f_n, K, M)


def _f_n(K, M):
    with np.errstate(divide="ignore"):
        return np.sqrt(K / M) / (2 * np.pi)


def omega_c(V, *, a, b, Dc):
    """Angular frequency [rad/s] at the Hopf bifurcation, where K = K_c(V).

    (V/Dc) sqrt((b - a)/a), whatever the mass; NaN where b <= a, for there is no bifurcation.
    """
    return _elementwise(_omega_c, V, a, b, Dc)


def _omega_c(V, a, b, Dc):
    return V / Dc * np.sqrt(np.where(b > a, (b - a) / a, np.nan))


def eigenvalues(V, *, a, b, Dc, sigma, K, M):
    """Eigenvalues [1/s] of small perturbations of steady sliding at V [m/s], for both laws.

    Returns
    -------
    complex array or DataArray
        Shape of the arguments, and then (in the dimension "mode") 3, least stable first; see
        `ratestate.modes.steady_modes`.  A mode faster than everything is -inf: one at M = 0, two
        at K = inf, where V is imposed and only the state relaxes, at the rate V/Dc.
    """
    return _elementwise(_eigenvalues, V, a, b, Dc, sigma, K, M, dims=("mode",))


def _eigenvalues(V, a, b, Dc, sigma, K, M):
    rigid = np.isinf(K)
    K = np.where(rigid, 1.0, K)
    inertia, kappa = eta(V, a=a, Dc=Dc, sigma=sigma, M=M), K * Dc / (a * sigma)
    margin = (K - K_c(V, a=a, b=b, Dc=Dc, sigma=sigma, M=M)) * Dc / (a * sigma)
    modes = steady_modes(inertia, kappa, b / a, margin)
    modes[rigid] = [-1.0, -np.inf, -np.inf]
    rate = (V / Dc)[..., None]
    modes.real, modes.imag = modes.real * rate, modes.imag * rate  # -inf times a complex is nan
    return modes


def _elementwise(function, *values, dims=()):
    """Function of NumPy arrays on floats, arrays or DataArrays; `dims` are added at the end."""
    if any(map(is_array, values)):
        import xarray

        def of_arrays(*arrays):
            return function(*np.broadcast_arrays(*arrays))

        return xarray.apply_ufunc(of_arrays, *values, output_core_dims=[dims])
    return function(*np.broadcast_arrays(*(np.asarray(value, float) for value in values)))[()]


def stability(slider, V_lp):
    """Linear stability of a slider in steady sliding.

    Parameters
    ----------
    slider : SpringSlider
        Parameters may be named DataArrays.
    V_lp : float, str, pint.Quantity or xarray.DataArray
        Load-point velocity [m/s], > 0.

    Returns
    -------
    xarray.Dataset
        In the dimensions of the named DataArrays together: ``K_c`` (eq. 6) and ``K_c_qs``
        [Pa/m], ``eta`` (eq. 7), ``V_c`` (eq. 10) [m/s], ``f_n`` [Hz], ``eigenvalues`` [1/s]
        (last dimension ``mode``, least stable first), ``growth_rate`` [1/s] and ``omega``
        [rad/s] (real and imaginary part of the first mode; omega is 0 if it does not
        oscillate), ``omega_c`` [rad/s] and ``stable`` (K > K_c).  For limits such as M = 0,
        K = inf or b <= a see the functions of the same names in this module.

    Raises
    ------
    ParameterError
        V_lp is not a speed > 0, or its coordinates clash with those of the slider.
    """
    import xarray

    V = to_si("V_lp", V_lp)
    parameters = slider.parameters
    law = parameters.pop("law")
    check_aligned({**parameters, "V_lp": V})
    a, b, Dc, sigma, K, M = (parameters[symbol] for symbol in ("a", "b", "Dc", "sigma", "K", "M"))
    modes = eigenvalues(V, a=a, b=b, Dc=Dc, sigma=sigma, K=K, M=M)
    modes = modes if is_array(modes) else xarray.DataArray(modes, dims="mode")
    first = modes.isel(mode=0)
    critical = K_c(V, a=a, b=b, Dc=Dc, sigma=sigma, M=M)
    variables = {
        "K_c": critical,
        "K_c_qs": K_c_qs(a=a, b=b, Dc=Dc, sigma=sigma),
        "eta": eta(V, a=a, Dc=Dc, sigma=sigma, M=M),
        "V_c": V_c(a=a, b=b, Dc=Dc, sigma=sigma, K=K, M=M),
        "f_n": f_n(K=K, M=M),
        "eigenvalues": modes,
        "growth_rate": first.real,
        "omega": abs(first.imag),
        "omega_c": omega_c(V, a=a, b=b, Dc=Dc),
        "stable": critical < K,
    }
    sweep = dict.fromkeys(dim for v in (*parameters.values(), V) if is_array(v) for dim in v.dims)
    if clash := [dim for dim in sweep if dim in variables]:
        raise ParameterError(f"a dimension called {clash[0]!r} clashes with the result; rename it")
    result = xarray.Dataset()
    for symbol, value in variables.items():
        result[symbol] = value if is_array(value) else xarray.DataArray(value)
        result[symbol].attrs = attrs(symbol)
    if not is_array(V):
        result.coords["V_lp"] = ((), V, attrs("V_lp"))
    elif "V_lp" not in V.dims:
        result.coords["V_lp"] = V
    result = result.transpose(*sweep, "mode", missing_dims="ignore")  # mu0 and V0 play no part
    return result.assign_attrs(slider=repr(slider), law=law)
