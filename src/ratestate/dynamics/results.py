"""Common parts of results: flags, provenance, the slider's parameters, domain of the law."""

import functools
import json
from importlib.metadata import version
from types import SimpleNamespace

import numpy as np

from ..engine.machine_code import DIGEST
from ..engine.model import STATUSES
from ..friction.composition import composed
from ..friction.laws import friction_law
from ..model.conversion import in_si
from ..model.slider import OPTIONAL, PARAMETERS
from ..model.units import is_array
from . import attributes
from .refusals import refusal


def columns(batch):
    """Return all values of a batch by name: (n,) arrays ``.a``, ``.b``, ``.Dc`` and so on."""
    return SimpleNamespace(**batch.columns)


def flags(meanings):
    """Return the CF attributes ``flag_values`` and ``flag_meanings`` from {number: meaning}."""
    words = (meaning.replace(" ", "_") for meaning in meanings.values())
    return {"flag_values": np.array(list(meanings), np.int8), "flag_meanings": " ".join(words)}


def status_variable(batch, status):
    """Return the status (n,) as a Variable in the sweep's dimensions: int8 with CF flags."""
    variable = batch.variable(np.asarray(status, np.int8), "status")
    variable.attrs |= flags({code: name for code, (name, _) in STATUSES.items()})
    return variable


#: flag of ``outside_domain`` -> its meaning
OUTSIDE_DOMAIN = {-1: "unknown", 0: "inside", 1: "mu_negative", 2: "spring_reverses", 3: "both"}
#: settings that are JSON in the attributes, as they may be arrays
AS_JSON = ("V_lp", "V_start", "t_end", "initial", "frequency")


def provenance(function, slider, **settings):
    """Return attributes from which a result can be reproduced, as a dict.

    They are the function's name, the slider, the versions of programs, and the settings that are
    not None.  Slider, versions and settings in `AS_JSON` are JSON.
    """
    given = {name: value for name, value in settings.items() if value is not None}
    return {
        "title": f"ratestate {function}",
        "slider": json.dumps(plain(slider.parameters)),
        **{name: json.dumps(plain(x)) if name in AS_JSON else x for name, x in given.items()},
        "versions": versions(),
    }


@functools.cache
def versions():
    """Return the versions of the programs that compute the numbers, as JSON."""
    programs = {name: version(name) for name in ("ratestate", "llvmlite", "numpy")}
    return json.dumps(programs | {"kernels": DIGEST})


# An attribute of a NetCDF file holds 64 KiB; longer lists go into variables.
MANY = 1000


def plain(value):
    """Return a value for JSON: a DataArray as ``{"dims": [...], "values": [...]}``.

    More than `MANY` values are replaced by "coordinate NAME", with the DataArray's name.
    """
    if isinstance(value, dict):
        return {name: plain(x) for name, x in value.items()}
    if not is_array(value):
        return value
    values = value.values.tolist() if value.size <= MANY else f"coordinate {value.name}"
    return {"dims": list(value.dims), "values": values}


def parameter(result, symbol):
    """Return a parameter of the slider that a result was made with, or its V_lp.

    Parameters
    ----------
    result : xarray.Dataset
        A result of any function.
    symbol : str
        The parameter's symbol, such as "K", or "law", "friction" or "V_lp"; damping and alpha
        are 0 by default.

    Returns
    -------
    float, DataArray or str
        A DataArray if the parameter was swept, with the cases that the result still has, or if it
        changes along a branch; a str for law and friction.

    Raises
    ------
    ParameterError
        The result has lost its attributes, they were altered, or the parameter is unknown.
    """
    result = in_si(result)
    if "parameter" in result.attrs and attributes.branch_parameter(result) == symbol:
        return result[symbol]
    name = "V_lp" if symbol == "V_lp" else "slider"
    value = attributes.from_json(result, name)
    if name == "slider":
        if isinstance(value, dict) and OPTIONAL.get(symbol) is not None:
            value = {symbol: OPTIONAL[symbol]} | value
        if not isinstance(value, dict) or symbol not in value:
            raise refusal("attributes.no_parameter", symbol=symbol)
        value = value[symbol]
    in_coordinate = isinstance(value, dict) and isinstance(value.get("values"), str)
    value = None if in_coordinate else attributes.parameter_value(name, symbol, value)
    if symbol in result.coords and not _labels(result[symbol], value):
        # with the cases that the result still holds
        return result[symbol] if result[symbol].ndim else result[symbol].item()
    if value is None:
        raise refusal("attributes.no_coordinate", symbol=symbol)
    return value


def law_of_result(result, law=None):
    """Return the friction law, with its friction form and damping, of a result's slider.

    law : its name, if the result has several
    """
    law = friction_law(law or parameter(result, "law"))
    return composed(law, parameter(result, "friction"), "damping" in slider_parameters(result))


def slider_parameters(result):
    """Return the symbols of the slider's parameters, with the area if a result records it."""
    known = attributes.from_json(result, "slider", dict)
    common = [*PARAMETERS, "law"]
    return [*common, *(symbol for symbol in known if symbol not in common)]


def _labels(coordinate, value):
    """Return whether a coordinate only labels a dimension of the same name as the symbol.

    Values that were converted to another unit and back may differ in the last digit.
    """
    if not is_array(value):
        return False
    same = np.isclose(np.asarray(coordinate)[..., None], value.values.ravel(), 1e-14, 0.0)
    return not same.any(axis=-1).all()


def normal_stress(result):
    """Return the normal stress [Pa] of a result of `simulate`, along its times if it varies."""
    return result["sigma"] if "sigma" in result.data_vars else parameter(result, "sigma")


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

    mu_min, reversal_margin : (n,) smallest mu and tau/sigma + mu; NaN if there is no motion
    """
    code = outside_domain(law, mu_min, reversal_margin)
    values = {"mu_min": mu_min, "reversal_margin": reversal_margin, "outside_domain": code}
    variables = {name: batch.variable(value, name) for name, value in values.items()}
    variables["outside_domain"].attrs |= flags(OUTSIDE_DOMAIN)
    return variables
