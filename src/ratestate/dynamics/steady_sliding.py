"""The function `stability`: linear stability of steady sliding."""

import dataclasses
import functools
from typing import Any

import numpy as np
import xarray

from ..friction.critical_speeds import V_c
from ..friction.linear_stability import K_c, eigenvalues, is_stable, omega_c
from ..friction.stability import call_elementwise, eta, f_n
from ..model.arrays import Batch
from ..model.names import keywords_checked
from ..model.quantities import attrs
from ..model.slider import SpringSlider, check_slider
from ..model.units import is_array, to_si
from .recipe import record_scenario
from .results import law_of_result, parameter

VARIABLES = "K_c K_c_qs eta V_c V_c_upper f_n eigenvalues growth_rate omega omega_c stable".split()


@keywords_checked
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
        In the dimensions of the named DataArrays on which each depends: ``K_c`` (eq. 6) and
        ``K_c_qs`` [Pa/m], ``eta`` (eq. 7), ``V_c`` (eq. 10) [m/s], ``f_n`` [Hz], ``eigenvalues``
        [1/s] (last dimension ``mode``, least stable first), ``growth_rate`` [1/s] and ``omega``
        [rad/s] (real and imaginary part of the first mode; omega is 0 if it does not
        oscillate), ``omega_c`` [rad/s] and ``stable`` (K > K_c).  Where K = inf, sliding
        is stable, V_c and f_n are inf, and the eigenvalues are -V/Dc and twice -inf; for other
        limits see the functions of these names in the module `ratestate.stability`.

    Raises
    ------
    ParameterError
        V_lp is not a speed > 0, or its coordinates clash with those of the slider.
    """
    call = stability_call(slider, V_lp)
    into_store = "Sweep into a store, sweep(stability, ..., store='x.zarr')."
    call.batch.check_fits(len(VARIABLES), into_store)
    return call.dataset(call.run())


def stability_call(slider, V_lp):
    """`StabilityCall` with these arguments of `stability`; ParameterError where one is wrong.

    Whether their dimensions and coordinates fit together shows in its `batch`.
    """
    return StabilityCall(check_slider(slider), to_si("V_lp", V_lp))


@dataclasses.dataclass(frozen=True, eq=False)
class StabilityCall:
    """`stability` with its arguments, checked and in SI."""

    slider: SpringSlider
    V_lp: Any

    @functools.cached_property
    def batch(self):
        """`Batch` of the slider's parameters and V_lp.

        ParameterError where dimensions or coordinates clash with each other or with the result's.
        """
        return Batch({**self.slider.values, "V_lp": self.V_lp}, reserved=VARIABLES)

    def blank(self):
        """The variables of `run` itself, with answers: they cost nothing."""
        return self.run()

    def run(self, progress=None):
        """The result's variables, name -> Variable in those dimensions on which it depends.

        progress : not called
        """
        law, V, values = self.slider.friction_law, self.V_lp, self.batch.values
        pick = {symbol: values[symbol] for symbol in (*law.symbols, "sigma", "K", "M")}
        of_spring = {"V": V} | pick
        of_mass = {symbol: x for symbol, x in of_spring.items() if symbol != "K"}

        def of_law(function, given, *dims):
            found = call_elementwise(functools.partial(function, law), given, *dims)
            return xarray.DataArray(found, dims=dims) if dims and not is_array(found) else found

        def both_speeds(law, **given):
            return np.stack(V_c(law, **given), axis=-1)

        modes, speeds = of_law(eigenvalues, of_spring, "mode"), of_law(both_speeds, pick, "edge")
        first = modes.isel(mode=0)
        results = {
            "K_c": of_law(K_c, of_mass),
            "K_c_qs": of_law(K_c, self._quasi_static(of_mass)),
            "eta": eta(V, **{symbol: values[symbol] for symbol in ("a", "Dc", "sigma", "M")}),
            "V_c": speeds.isel(edge=0),
            "V_c_upper": speeds.isel(edge=1),
            "f_n": f_n(K=values["K"], M=values["M"]),
            "eigenvalues": modes,
            "growth_rate": first.real,
            "omega": abs(first.imag),
            "omega_c": of_law(omega_c, of_mass),
            "stable": of_law(is_stable, of_spring),
        }
        variables = {}
        for symbol, value in results.items():
            variable = value.variable if is_array(value) else xarray.Variable((), value)
            variable = variable.transpose(*self.batch.dims, ..., missing_dims="ignore")
            variables[symbol] = xarray.Variable(variable.dims, variable.values, attrs(symbol))
        return variables

    def _quasi_static(self, given):
        """The same without mass; and at any speed, where it makes no difference."""
        any_speed = {} if self.slider.friction_law.has_speed_scale else {"V": 1.0}
        return given | any_speed | {"M": 0.0}

    def dataset(self, variables):
        """Return these variables of all cases as a Dataset with coordinates and scenario."""
        result = xarray.Dataset(variables, self.batch.coordinates(VARIABLES))
        record_scenario(result, "stability", self.slider, V_lp=self.V_lp)
        return result


def steady_stress(result, V):
    """tau/sigma [1] in steady sliding at speeds V [m/s], (n,) or one, of a result's slider."""
    law = law_of_result(result)
    symbols = (*law.symbols, "sigma", "mu0", "V0")
    values = {symbol: float(parameter(result, symbol)) for symbol in symbols}
    return law.steady_tau(np.atleast_1d(np.asarray(V, float)), values).reshape(np.shape(V))
