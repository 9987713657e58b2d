"""Common parts of results: flags, status, parameters, the law's domain, forces of the contact."""

import dataclasses
import json
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np
import xarray

from ..engine.model import STATUSES
from ..friction.composition import composed
from ..friction.forms import form_name
from ..friction.laws import friction_law, law_name
from ..model.conversion import in_si
from ..model.parameters import force
from ..model.quantities import QUANTITIES, attrs
from ..model.slider import SpringSlider
from ..model.slider_parameters import OPTIONAL, PARAMETERS
from ..model.units import is_array, to_si
from .recipe import recorded, recorded_result, value_of, versions
from .refusals import refusal

#: flag of ``outside_domain`` -> its meaning
OUTSIDE_DOMAIN = {-1: "unknown", 0: "inside", 1: "mu_negative", 2: "spring_reverses", 3: "both"}


@dataclasses.dataclass(frozen=True, eq=False)
class CheckedCall:
    """Base class of a function with its arguments, checked and in SI, which may be swept.

    A subclass has its arguments as fields.
    """

    slider: SpringSlider
    function: ClassVar[str]  # its name
    names: ClassVar[Any]  # names of the variables, which a coordinate must not have
    batch: ClassVar[Any]  # `Batch` of all values
    run: ClassVar[Any]  # method that returns the variables of all cases

    @property
    def arguments(self):
        """The arguments to be recorded, name -> value."""
        fields = (field.name for field in dataclasses.fields(self))
        return {name: getattr(self, name) for name in fields}

    def blank(self):
        """Return the variables of `run` with no case solved; all of them, if they cost nothing."""
        return self.run()

    def dataset(self, variables):
        """Return these variables of all cases as a Dataset with coordinates and scenario."""
        names, arguments = self.names, self.arguments
        call = self.function, arguments.pop("slider"), self.batch
        return recorded_result(*call, variables, names, **arguments)


def columns(batch):
    """Return all values of a batch by name: (n,) arrays ``.a``, ``.b``, ``.Dc`` and so on."""
    return SimpleNamespace(**batch.columns)


def flags(meanings):
    """Return CF attributes ``flag_values`` (int8) and ``flag_meanings``, from {number: meaning}."""
    words = (meaning.replace(" ", "_") for meaning in meanings.values())
    return {"flag_values": np.array(list(meanings), np.int8), "flag_meanings": " ".join(words)}


def own_variable(batch, symbol, value):
    """Return a float or DataArray as a Variable in the dimensions on which it depends."""
    variable = value.variable if is_array(value) else xarray.Variable((), value)
    variable = variable.transpose(*batch.dims, ..., missing_dims="ignore")
    return xarray.Variable(variable.dims, variable.values, attrs(symbol))


def status_variable(batch, status):
    """Return the status (n,) of the cases as a Variable of the sweep: int8 with CF flags."""
    variable = batch.variable(np.asarray(status, np.int8), "status")
    variable.attrs |= flags({code: name for code, (name, _) in STATUSES.items()})
    return variable


def provenance(function, slider, **settings):
    """Return attributes (dict) of a result that has no scenario, such as a fit.

    They are the function's name, the slider, the versions of programs, and the settings that are
    not None.  The slider, without parameters that are arrays, and the versions are JSON.
    """
    known = {symbol: x for symbol, x in slider.parameters.items() if not is_array(x)}
    given = {name: value for name, value in settings.items() if value is not None}
    attributes = {"title": f"ratestate {function}", "slider": json.dumps(known)}
    return {**attributes, **given, "versions": versions()}


def parameter(result, symbol):
    """Return the value of a parameter or argument with which a result was computed.

    Raises ParameterError if the result has lost its attributes, if they were altered, or if it does
    not record the parameter, such as an area that was not given.

    Parameters
    ----------
    result : xarray.Dataset
        A result of any function.
    symbol : str
        The parameter's symbol, such as "K", or "law", "friction_form", "V_lp" or "rtol".  Damping
        and alpha are 0 if the slider has none.

    Returns
    -------
    float, DataArray or str
        The value.  It is a DataArray if the parameter was swept, or changes along a branch
        (``point``).  It has only the cases that the result has.
    """
    result = in_si(result)
    call = recorded(result)
    if call.get("parameter") is not None and branch_parameter(result) == symbol:
        return result[symbol]
    known = call | call["slider"]
    value = known.get(symbol, OPTIONAL.get(symbol))
    if value is None or symbol not in (*QUANTITIES, "law", "friction_form"):
        raise refusal("attributes.no_parameter", symbol=symbol)
    if symbol == "law":
        law = result.coords.get("law")  # of a case of results that were joined
        return law_name(value if law is None or law.ndim else law.item())
    if symbol == "friction_form":
        return form_name(value)
    value = value_of(result, symbol, value)
    checked = to_si(symbol, value)
    return value if is_array(value) else checked


def slider_parameters(result):
    """Return the symbols (list of str) of the slider's parameters, its area included if recorded.

    Raises ParameterError if the result has lost its attributes.
    """
    common = [*PARAMETERS, "law"]
    return [*common, *(symbol for symbol in recorded(result)["slider"] if symbol not in common)]


def law_of_result(result, law=None):
    """Return the friction law of the slider that a result was made with, composed of its parts.

    law : name of the law if the result has several
    """
    law = friction_law(law or parameter(result, "law"))
    return composed(law, parameter(result, "friction_form"), "damping" in slider_parameters(result))


def normal_stress(result):
    """Return the normal stress [Pa] of a result of `simulate`: along its times if it varies."""
    return result["sigma"] if "sigma" in result.data_vars else parameter(result, "sigma")


def branch_parameter(result):
    """Return the symbol of the parameter that changes along a branch of cycles.

    Raises ParameterError if the result does not record it, or has no values of it along ``point``.
    """
    symbol = recorded(result).get("parameter")
    known = isinstance(symbol, str) and symbol in QUANTITIES
    if not known or "point" not in getattr(result.get(symbol), "dims", ()):
        raise refusal("attributes.no_branch")
    return symbol


def outside_domain(law, mu_min, reversal_margin):
    """Return whether the motion leaves the law's domain, int8 of `OUTSIDE_DOMAIN`.

    Eq. 1 is for forward slip, V > 0, against which friction acts.  It allows mu < 0, where friction
    would have to push; and it does not reverse the slip if the spring pulls the slider back harder
    than friction can hold, tau < -sigma mu.  The computed motion goes on, but no real slider moves
    like that.  Friction that is finite at rest allows both: there slip reverses.
    """
    outside = (mu_min < 0.0) + 2 * (reversal_margin < 0.0)
    outside = np.where(law.reverses, 0, outside)
    return np.where(np.isnan(mu_min), -1, outside).astype(np.int8)


def domain_variables(law, batch, mu_min, reversal_margin):
    """Return ``mu_min``, ``reversal_margin`` and ``outside_domain``, name -> Variable.

    mu_min, reversal_margin : (n,) smallest mu and tau/sigma + mu; NaN without a motion
    """
    code = outside_domain(law, mu_min, reversal_margin)
    values = {"mu_min": mu_min, "reversal_margin": reversal_margin, "outside_domain": code}
    variables = {name: batch.variable(value, name) for name, value in values.items()}
    variables["outside_domain"].attrs |= flags(OUTSIDE_DOMAIN)
    return variables


def contact_area(result):
    """Return the area of the contact [m^2]; None if it is not known, or not one number."""
    area = parameter(result, "area") if "area" in slider_parameters(result) else None
    return None if is_array(area) else area


def whole_contact(result):
    """Return forces and motions of the whole contact, a Dataset; none if its area is not known.

    Of a run, along ``time``: ``force`` [N] of the spring, and ``acceleration`` [m/s^2], eq. 4.  Per
    case: ``force_amplitude`` [N] and ``displacement_amplitude`` [m], relative to the load point,
    both peak-to-peak in the last cycle; ``acceleration_max`` [m/s^2], the largest one of either
    sign.  Accelerations are NaN if M = 0.

    result : from `simulate`, `limit_cycle` or `continue_cycle`
    """
    if "area" not in slider_parameters(result):
        return xarray.Dataset()
    sigma, K, M, area = (parameter(result, symbol) for symbol in ("sigma", "K", "M", "area"))
    M = M.where(M > 0.0) if is_array(M) else M or np.nan
    found = {}
    if "tau" in result:
        found["force"] = force(result["tau"], area)
        resistance = sigma * result["mu"] + parameter(result, "damping") * result["V"]
        found["acceleration"] = (result["tau"] - resistance) / M
    if "amplitude" in result:
        stress = result["amplitude"] * sigma
        found["force_amplitude"] = force(stress, area)
        found["displacement_amplitude"] = stress / K
        of_run = "inertial_force" in result
        largest = result["inertial_force"] if of_run else result["inertia"] * result["amplitude"]
        found["acceleration_max"] = largest * sigma / M
    data = xarray.Dataset({symbol: value.drop_attrs(deep=False) for symbol, value in found.items()})
    for symbol in found:
        data[symbol].attrs = attrs(symbol)
    return data
