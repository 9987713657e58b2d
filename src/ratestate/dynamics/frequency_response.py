"""The function `frequency_response`: what small oscillations do to steady sliding."""

import dataclasses
import functools
from typing import Any

import numpy as np
import xarray

from ..friction.linear_stability import eigenvalues, is_stable, responses
from ..friction.stability import eta, f_n
from ..model.arrays import Batch
from ..model.names import keywords_checked
from ..model.parameters import logspace
from ..model.slider import SpringSlider, check_slider
from ..model.units import to_si
from .recipe import record_scenario
from .refusals import refusal
from .results import columns

#: what answers, per what oscillates
TRANSFER = tuple(f"{out}_by_{given}" for given in ("V_lp", "sigma") for out in ("V", "tau", "mu"))
OF_SLIDER = ("resonance", "quality", "stable")
#: in a decade, where no frequencies are given
POINTS = 60
VARIABLES = (
    *TRANSFER,
    *(f"{name}_{x}" for name in TRANSFER for x in ("gain", "phase")),
    *OF_SLIDER,
)


@keywords_checked
def frequency_response(slider, V_lp, frequency=None):
    """The response of steady sliding to small sinusoids of load-point speed and normal stress.

    Of a linear system: an oscillation of V_lp by the amplitude A makes one of tau by tau_by_V_lp A,
    a complex number, whose size is the gain, and whose angle is the phase by which it leads.

    Parameters
    ----------
    slider : SpringSlider
        Parameters may be named DataArrays.  ``alpha`` is the response of its state to normal
        stress, ``damping`` counts, and so does mass.
    V_lp : float, str, pint.Quantity or DataArray
        Load-point velocity about which all oscillates [m/s], > 0.
    frequency : float, str, pint.Quantity, array_like or DataArray, optional
        Frequency [Hz], > 0; a list or a one-dimensional array is along ``frequency``.  By default
        60 a decade, from the decade below to the one above those that hold V_lp/(2 pi Dc), by which
        the state follows, f_n and the resonance.

    Returns
    -------
    xarray.Dataset
        In the dimensions of the named DataArrays together, complex: ``V_by_V_lp`` [1],
        ``tau_by_V_lp`` [Pa s/m], ``mu_by_V_lp`` [s/m], ``V_by_sigma`` [m/(Pa s)],
        ``tau_by_sigma`` [1] and ``mu_by_sigma`` [1/Pa]; of each the ``_gain`` and the ``_phase``
        [rad], from -pi to pi, such as ``tau_by_V_lp_gain``.  V is the slider's speed, tau the
        spring's stress.

        In the dimensions but that of frequency: ``resonance`` [Hz], the frequency at which the
        slider oscillates by itself, and its ``quality`` [1], by which it dies away
        (exp(-pi/quality) a period, for a large one); NaN where it does not oscillate.  They are
        those of the least damped pair of eigenvalues l: |Im l|/(2 pi) and |l|/(2 |Re l|).  Near
        K_c the resonance is that of the Hopf bifurcation.  ``stable``: whether steady sliding is;
        where it is not no response settles, and all else is NaN.

    Raises
    ------
    ParameterError
        Wrong values or units; arrays that clash; a single slider whose steady sliding is unstable.

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
        raise refusal("response.unstable", V_lp=call.V_lp, K=slider.K)
    return call.dataset(call.run())


def frequency_response_call(slider, V_lp, frequency=None):
    """`FrequencyResponseCall` with these arguments of `frequency_response`; ParameterError.

    Whether their dimensions and coordinates fit together shows in its `batch`.
    """
    V_lp = to_si("V_lp", V_lp)
    if frequency is None:
        frequency = _usual_frequencies(check_slider(slider), V_lp)
    frequency = to_si("frequency", _along_itself(frequency), bound="> 0")
    return FrequencyResponseCall(check_slider(slider), V_lp, frequency)


@dataclasses.dataclass(frozen=True, eq=False)
class FrequencyResponseCall:
    """`frequency_response` with its arguments, checked and in SI."""

    slider: SpringSlider
    V_lp: Any
    frequency: Any

    @functools.cached_property
    def batch(self):
        """`Batch` of the slider's parameters, V_lp and frequency; ParameterError where they clash.

        Its dimensions are those of the result.
        """
        values = {**self.slider.values, "V_lp": self.V_lp, "frequency": self.frequency}
        return Batch(values, reserved=VARIABLES)

    @property
    def sliders(self):
        """`Batch` of the slider's parameters and V_lp."""
        return Batch({**self.slider.values, "V_lp": self.V_lp})

    @functools.cached_property
    def resonances(self):
        """Resonance, quality and stability of `sliders`, name -> (n,)."""
        return _of_sliders(self.slider.friction_law, self.sliders)

    def blank(self):
        """The variables of `run` itself, with answers: they cost nothing."""
        return self.run()

    def run(self, progress=None):
        """The result's variables, name -> Variable, NaN where steady sliding is unstable.

        progress : not called
        """
        sliders = self.sliders
        variables = {name: sliders.variable(x, name) for name, x in self.resonances.items()}
        for name, value in _transfer(self.slider, self.batch).items():
            whole = self.batch.variable(value, name).where(variables["stable"])
            text = whole.attrs["long_name"]
            gain = whole.attrs | {"long_name": f"{text}, gain"}
            phase = {"units": "rad", "long_name": f"{text}, phase"}
            variables[name] = whole
            variables[f"{name}_gain"] = xarray.Variable(whole.dims, np.abs(whole.values), gain)
            variables[f"{name}_phase"] = xarray.Variable(whole.dims, np.angle(whole.values), phase)
        return variables

    def dataset(self, variables):
        """Return these variables of all cases as a Dataset with coordinates and scenario."""
        settings = {"V_lp": self.V_lp, "frequency": self.frequency}
        result = xarray.Dataset(variables, self.batch.coordinates(VARIABLES))
        record_scenario(result, "frequency_response", self.slider, **settings)
        return result


def _usual_frequencies(slider, V_lp):
    """The frequencies of a response for which none are given, along ``frequency``."""
    batch = Batch({**slider.values, "V_lp": V_lp})
    p, found = columns(batch), _of_sliders(slider.friction_law, batch)
    scales = [p.V_lp / (2.0 * np.pi * p.Dc), f_n(K=p.K, M=p.M), found["resonance"]]
    known = [x[np.isfinite(x) & (x > 0.0)] for x in scales]
    exponents = np.log10(np.concatenate(known))
    low, high = int(np.floor(exponents.min())) - 1, int(np.ceil(exponents.max())) + 1
    return logspace("frequency", float(f"1e{low}"), float(f"1e{high}"), POINTS * (high - low) + 1)


def _along_itself(frequency):
    """A list or an array of frequencies as a DataArray."""
    if isinstance(frequency, list | tuple | np.ndarray) and np.ndim(frequency) == 1:
        values = [to_si("frequency", f, bound="> 0") for f in frequency]
        return xarray.DataArray(values, dims="frequency") if values else frequency
    return frequency


def _of_sliders(law, batch):
    """Resonance, quality and stability of sliders, name -> (n,)."""
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
    """The transfer functions, name -> (n,) complex."""
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
