"""The functions `stability` and `frequency_response`: small disturbances of steady sliding."""

import dataclasses
import functools
from typing import Any

import numpy as np
import xarray

from ..friction.closed_forms import call_elementwise, eta, f_n
from ..friction.critical_speeds import V_c
from ..friction.linear_stability import K_c, eigenvalues, is_stable, omega_c, responses
from ..model.arrays import Batch
from ..model.names import keywords_checked
from ..model.parameters import logspace, of_contact
from ..model.slider import check_slider
from ..model.units import is_array, to_si
from .refusals import refusal
from .results import CheckedCall, columns, law_of_result, own_variable, parameter

VARIABLES = "K_c K_c_qs eta V_c V_c_upper f_n eigenvalues growth_rate omega omega_c stable".split()
#: of a response: what answers, per what oscillates
TRANSFER = tuple(f"{out}_by_{given}" for given in ("V_lp", "sigma") for out in ("V", "tau", "mu"))
RESPONSE_VARIABLES = (
    *TRANSFER,
    *(f"{name}_{x}" for name in TRANSFER for x in ("gain", "phase")),
    *("resonance", "quality", "stable"),
)
# Default frequencies in a decade.
POINTS = 60


@keywords_checked
def stability(slider, V_lp):
    """Compute the linear stability of a slider in steady sliding.

    Parameters
    ----------
    slider : SpringSlider
        Parameters may be named DataArrays.
    V_lp : float, str, pint.Quantity or xarray.DataArray
        Load-point velocity [m/s], > 0.

    Returns
    -------
    xarray.Dataset
        Each variable has the dimensions of the named DataArrays on which it depends:

        - ``K_c`` and ``K_c_qs``: critical stiffness with inertia (eq. 6) and without [Pa/m];
        - ``eta``: dynamic instability coefficient (eq. 7);
        - ``V_c``: critical velocity (eq. 10) [m/s]: sliding is stable below and unstable above it.
          0 if sliding is unstable at every speed, inf if it is stable at every speed;
        - ``V_c_upper``: speed above which sliding is stable again under some laws, else inf; in the
          dimensions of ``V_c``;
        - ``f_n``: natural frequency [Hz];
        - ``eigenvalues`` [1/s], in the dimension ``mode``, least stable first.  Their number is the
          number of the law's states plus 2;
        - ``growth_rate`` [1/s] and ``omega`` [rad/s]: real and imaginary part of the first
          eigenvalue; omega is 0 if this mode does not oscillate;
        - ``omega_c``: angular frequency at the Hopf bifurcation [rad/s], NaN if b < a;
        - ``stable``: whether all modes decay.  For most laws this means K > K_c, and K_c < 0 if
          b < a.

    Raises
    ------
    ParameterError
        If V_lp is not a speed > 0, or if its coordinates clash with the slider's.

    Notes
    -----
    If M = 0, f_n is inf, and one eigenvalue is -inf.  If K = inf, sliding is stable, V_c and f_n
    are inf, and the eigenvalues are -V/Dc and twice -inf.  For other limits see the functions of
    these names in `ratestate.formulas`.
    """
    call = stability_call(slider, V_lp)
    into_store = "Sweep into a store, sweep(stability, ..., store='x.zarr')."
    call.batch.check_fits(len(VARIABLES), into_store)
    return call.dataset(call.run())


def stability_call(slider, V_lp):
    """Return the `StabilityCall` with these arguments of `stability`, checked one by one."""
    return StabilityCall(check_slider(slider), to_si("V_lp", V_lp))


@dataclasses.dataclass(frozen=True, eq=False)
class StabilityCall(CheckedCall):
    """`stability` with its arguments, checked and in SI."""

    V_lp: Any
    function, names = "stability", VARIABLES

    @functools.cached_property
    def batch(self):
        """`Batch` of the slider's parameters and V_lp; ParameterError if dimensions clash."""
        return Batch({**self.slider.values, "V_lp": self.V_lp}, reserved=VARIABLES)

    def run(self, progress=None):
        """Return the variables, name -> Variable in the dimensions on which each depends."""
        law, V, values = self.slider.friction_law, self.V_lp, self.batch.values
        pick = {symbol: values[symbol] for symbol in (*law.symbols, "sigma", "K", "M")}
        of_spring = {"V": V} | pick
        of_mass = {symbol: x for symbol, x in of_spring.items() if symbol != "K"}

        # Without mass, and without a speed of the law's own, the speed makes no difference.
        any_speed = {} if law.has_speed_scale else {"V": 1.0}

        def evaluated(function, given, *dims):
            found = call_elementwise(functools.partial(function, law), given, *dims)
            return xarray.DataArray(found, dims=dims) if dims and not is_array(found) else found

        def edge_speeds(law, **given):
            return np.stack(V_c(law, **given), axis=-1)

        modes = evaluated(eigenvalues, of_spring, "mode")
        speeds = evaluated(edge_speeds, pick, "edge")
        first = modes.isel(mode=0)
        results = {
            "K_c": evaluated(K_c, of_mass),
            "K_c_qs": evaluated(K_c, of_mass | any_speed | {"M": 0.0}),
            "eta": eta(V, **{symbol: values[symbol] for symbol in ("a", "Dc", "sigma", "M")}),
            "V_c": speeds.isel(edge=0),
            "V_c_upper": speeds.isel(edge=1),
            "f_n": f_n(K=values["K"], M=values["M"]),
            "eigenvalues": modes,
            "growth_rate": first.real,
            "omega": abs(first.imag),
            "omega_c": evaluated(omega_c, of_mass),
            "stable": evaluated(is_stable, of_spring),
        }
        return {symbol: own_variable(self.batch, symbol, x) for symbol, x in results.items()}


def steady_stress(result, V):
    """Return tau/sigma [1] of a result's slider in steady sliding at speeds V [m/s]."""
    law = law_of_result(result)
    symbols = (*law.symbols, "sigma", "mu0", "V0")
    values = {symbol: float(parameter(result, symbol)) for symbol in symbols}
    return law.steady_tau(np.atleast_1d(np.asarray(V, float)), values).reshape(np.shape(V))


@keywords_checked
def frequency_response(slider, V_lp, frequency=None):
    """Compute how steady sliding responds to small sinusoids of speed and normal stress.

    The response is linear: if V_lp oscillates with the amplitude A, tau oscillates with the
    amplitude |tau_by_V_lp| A.  The magnitude of the complex tau_by_V_lp is the gain.  Its angle is
    the phase by which tau leads.

    Parameters
    ----------
    slider : SpringSlider
        Parameters may be named DataArrays.
    V_lp : float, str, pint.Quantity or DataArray
        Mean load-point velocity [m/s], > 0.
    frequency : float, str, pint.Quantity, array_like or DataArray, optional
        Frequency [Hz], > 0.  A list or 1-D array gets the dimension ``frequency``.  By default
        there are 60 frequencies per decade, the same for all cases of a sweep.  They extend by a
        decade or more, to a power of ten, on both sides of V_lp/(2 pi Dc), f_n and the resonance.

    Returns
    -------
    xarray.Dataset
        Complex responses, in the dimensions of all named DataArrays:

        - ``V_by_V_lp`` [1], ``tau_by_V_lp`` [Pa s/m] and ``mu_by_V_lp`` [s/m], with the slider's
          speed V and the spring's stress tau;
        - ``V_by_sigma`` [m/(Pa s)], ``tau_by_sigma`` [1] and ``mu_by_sigma`` [1/Pa];
        - the gain and the phase [rad] of each, such as ``tau_by_V_lp_gain`` and
          ``tau_by_V_lp_phase``, from -pi to pi.

        In the dimensions without frequency:

        - ``resonance`` [Hz]: the frequency at which the slider oscillates by itself; NaN if it does
          not oscillate;
        - ``quality`` [1]: quality factor of the resonance.  If it is large, oscillations decay by
          the factor exp(-pi/quality) in a period;
        - ``stable``: whether steady sliding is stable.  If not, all other variables are NaN.

    Raises
    ------
    ParameterError
        If a value or unit is wrong, or if arrays clash.  Also if the steady sliding of a single
        slider is unstable.

    Notes
    -----
    Resonance and quality follow from the least damped pair of eigenvalues l: |Im l|/(2 pi) and
    |l|/(2 |Re l|).  Near K_c the resonance is the frequency of the Hopf bifurcation.

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m", M=3000)
    >>> response = rs.frequency_response(slider, "3 mm/s", [10.0, 50.0])
    >>> round(float(response.resonance), 2), response.V_by_V_lp_gain.values.round(2)
    (48.72, array([ 1.06, 24.04]))
    """
    call = frequency_response_call(slider, V_lp, frequency)
    call.batch.check_fits(4 * len(TRANSFER), "Ask for fewer frequencies at a time.")
    if call.sliders.is_single and not call.resonances["stable"][0]:
        raise refusal("response.unstable", V_lp=call.V_lp, K=of_contact("K", slider.K, slider.area))
    return call.dataset(call.run())


def frequency_response_call(slider, V_lp, frequency=None):
    """Return the `FrequencyResponseCall` with these arguments, checked one by one."""
    V_lp = to_si("V_lp", V_lp)
    if frequency is None:
        frequency = _default_frequencies(check_slider(slider), V_lp)
    frequency = to_si("frequency", _frequency_array(frequency), bound="> 0")
    return FrequencyResponseCall(check_slider(slider), V_lp, frequency)


@dataclasses.dataclass(frozen=True, eq=False)
class FrequencyResponseCall(CheckedCall):
    """`frequency_response` with its arguments, checked and in SI."""

    V_lp: Any
    frequency: Any
    function, names = "frequency_response", RESPONSE_VARIABLES

    @functools.cached_property
    def batch(self):
        """`Batch` of the slider's parameters, V_lp and frequency; ParameterError if they clash."""
        values = {**self.slider.values, "V_lp": self.V_lp, "frequency": self.frequency}
        return Batch(values, reserved=RESPONSE_VARIABLES)

    @property
    def sliders(self):
        """`Batch` of the slider's parameters and V_lp."""
        return Batch({**self.slider.values, "V_lp": self.V_lp})

    @functools.cached_property
    def resonances(self):
        """Resonance, quality and stability of `sliders`, name -> (n,)."""
        return _resonances(self.slider.friction_law, self.sliders)

    def run(self, progress=None):
        """Return the variables, name -> Variable, NaN where steady sliding is unstable."""
        sliders = self.sliders
        variables = {name: sliders.variable(x, name) for name, x in self.resonances.items()}
        for name, value in _transfer(self.slider, self.batch).items():
            response = self.batch.variable(value, name).where(variables["stable"])
            dims, text = response.dims, response.attrs["long_name"]
            gain = response.attrs | {"long_name": f"{text}, gain"}
            phase = {"units": "rad", "long_name": f"{text}, phase"}
            variables[name] = response
            variables[f"{name}_gain"] = xarray.Variable(dims, np.abs(response.values), gain)
            variables[f"{name}_phase"] = xarray.Variable(dims, np.angle(response.values), phase)
        return variables


def _default_frequencies(slider, V_lp):
    """Return the default frequencies of a response, along ``frequency``."""
    batch = Batch({**slider.values, "V_lp": V_lp})
    p, found = columns(batch), _resonances(slider.friction_law, batch)
    scales = [p.V_lp / (2.0 * np.pi * p.Dc), f_n(K=p.K, M=p.M), found["resonance"]]
    known = [x[np.isfinite(x) & (x > 0.0)] for x in scales]
    exponents = np.log10(np.concatenate(known))
    low, high = int(np.floor(exponents.min())) - 1, int(np.ceil(exponents.max())) + 1
    return logspace("frequency", float(f"1e{low}"), float(f"1e{high}"), POINTS * (high - low) + 1)


def _frequency_array(frequency):
    """Return a list or an array of frequencies as a DataArray."""
    if isinstance(frequency, list | tuple | np.ndarray) and np.ndim(frequency) == 1:
        values = [to_si("frequency", f, bound="> 0") for f in frequency]
        return xarray.DataArray(values, dims="frequency") if values else frequency
    return frequency


def _resonances(law, batch):
    """Return resonance, quality and stability of sliders, name -> (n,)."""
    columns = batch.columns
    given = {symbol: columns[symbol] for symbol in (*law.symbols, "sigma", "K", "M")}
    stable = is_stable(law, columns["V_lp"], **given)
    modes = eigenvalues(law, columns["V_lp"], **given)
    oscillates = (modes.imag != 0.0) & (modes.real < 0.0)
    decay = np.where(oscillates, -modes.real, np.inf)
    least = decay.argmin(axis=-1)[:, None]
    mode = np.take_along_axis(modes, least, -1)[:, 0]
    is_resonant = stable & oscillates.any(axis=-1)
    with np.errstate(invalid="ignore", divide="ignore"):
        resonance = np.where(is_resonant, np.abs(mode.imag) / (2.0 * np.pi), np.nan)
        quality = np.where(is_resonant, 0.5 * np.abs(mode) / np.abs(mode.real), np.nan)
    return {"resonance": resonance, "quality": quality, "stable": stable}


def _transfer(slider, batch):
    """Return the transfer functions, name -> (n,) complex."""
    law, p, values = slider.friction_law, columns(batch), batch.columns
    V, unit = p.V_lp, p.a * p.sigma
    mu = law.steady_friction(V, values)
    h = law.jumps_with_normal_stress(mu, batch.flat("alpha") if slider.has_alpha else 0.0, p)
    inertia = eta(V, a=p.a, Dc=p.Dc, sigma=p.sigma, M=p.M)
    Omega = 2.0 * np.pi * batch.flat("frequency") * p.Dc / V
    coefficients = law.coefficient_arrays(V, values)
    kappa = p.K * p.Dc / unit
    to_speed, to_stress = responses(law, coefficients, kappa, inertia, mu / p.a, h, Omega)
    return {
        "V_by_V_lp": to_speed.v,
        "tau_by_V_lp": unit * to_speed.x / V,
        "mu_by_V_lp": p.a * to_speed.f / V,
        "V_by_sigma": V * to_stress.v / p.sigma,
        "tau_by_sigma": p.a * to_stress.x,
        "mu_by_sigma": p.a * to_stress.f / p.sigma,
    }
