"""The scenario that made a result, from the attributes of the result."""

import inspect
from typing import Any

import numpy as np
import xarray

from ...dynamics import attributes
from ...dynamics.recorded_loading import recorded_loading, with_labels
from ...dynamics.results import parameter
from ...errors import ParameterError
from ...friction.forms import parameters_of
from ...friction.law_formula import HASH_MARK, LOG
from ...friction.laws import DEFAULT, find_law_name, friction_law
from ...model.conversion import in_si
from ...model.slider import OPTIONAL, SpringSlider
from ...model.units import is_array
from .known_keys import COMMON
from .model import FUNCTIONS, Scenario

WANTED = "Give a Dataset that a function of ratestate returned, or that was read from its file."


def from_result(result: Any) -> Scenario:
    """The scenario that made a result: run again, it gives the same bits.

    Parameters
    ----------
    result : xarray.Dataset
        Of `simulate`, `limit_cycle`, `stability`, `frequency_response` or `continue_cycle`, or of a
        sweep of one, as it was returned or as it is read from a file.

    Returns
    -------
    Scenario
        The scenario, without output.

    Raises
    ------
    ParameterError
        The Dataset has lost attributes or variables that tell how it was made.
    """
    if not isinstance(result, xarray.Dataset):
        raise ParameterError(f"a {type(result).__name__} is not a result", WANTED)
    result = in_si(result)
    title = str(result.attrs.get("title", ""))
    verb = title.removeprefix("ratestate ")
    if title == "ratestate fit":
        raise ParameterError(
            "the result is a fit, which has no scenario",
            "Fit the record again with ratestate fit, or with the lines of Python in its "
            "report.md. ratestate.fitting.slider_of(result) is the slider that it found.",
        )
    if verb not in FUNCTIONS or not title.startswith("ratestate "):
        raise ParameterError(
            f"the result's title is {title[:60]!r}, which no function of ratestate writes", WANTED
        )
    try:
        scenario = Scenario(verb, _slider(result), _settings(verb, result))
        _check(scenario)
    except ParameterError:
        raise
    except Exception as error:  # variables too may be gone, or others than they were
        raise ParameterError(
            f"this {verb} lacks a part of its scenario ({type(error).__name__}: {error})", WANTED
        ) from None
    return scenario


def _check(scenario: Scenario) -> None:
    """Raise ParameterError for a scenario that its function would refuse."""
    function = FUNCTIONS[scenario.verb]
    bound = inspect.signature(function.call).bind(scenario.slider, **scenario.settings)
    bound.apply_defaults()
    getattr(function.checked(**bound.arguments), "batch", None)  # refuses arrays that clash


def _slider(result: Any) -> SpringSlider:
    """The slider, with the cases that the result still has."""
    values = attributes.from_json(result, "slider", dict)
    law = values.get("law", DEFAULT)
    if isinstance(law, str) and HASH_MARK in law and not find_law_name(law):
        raise ParameterError(*_unknown_law(law))
    of_law = friction_law(law).parameters.keys() | parameters_of(values.get("friction", LOG)).keys()
    wanted = COMMON.keys() | of_law
    if odd := (wanted ^ values.keys()) - {*OPTIONAL}:
        raise ParameterError(
            f"the attribute 'slider' of the Dataset has these parameters too many or too few: "
            f"{', '.join(sorted(odd))[:100]}",
            WANTED,
        )
    followed = result.attrs.get("parameter")
    swept = {k: _value_of(result, "slider", k, v) for k, v in values.items() if k != followed}
    return SpringSlider(**values | swept)


def _unknown_law(law: str) -> tuple[str, str]:
    """The problem and the remedy for a user's law that is not known."""
    own = law.partition(HASH_MARK)[0]
    problem = f"the result is of the law {law!r}, a user's own law that is not known here"
    if other := find_law_name(own):
        problem += f" (the known {own} is {other!r}, from another source, such as an edited file)"
    return problem, f"Give its file: --law-file {own}.py or ratestate.register('{own}.py')."


def _settings(verb: str, result: Any) -> dict[str, Any]:
    """The function's arguments but for the slider, and without those equal to its defaults."""
    settings = {}
    for key, argument in list(inspect.signature(FUNCTIONS[verb].call).parameters.items())[1:]:
        value = _setting(verb, result, key)
        many = is_array(value) or isinstance(value, np.ndarray)
        if many or not (value is None or value == {} or value == argument.default):
            settings[key] = value
    if "loading" in settings and "V_start" in settings:
        first, start = map(xarray.DataArray, (settings["loading"].V_first, settings["V_start"]))
        if first.equals(start):
            del settings["V_start"]
    return settings


def _setting(verb: str, result: Any, key: str) -> Any:
    """The value of an argument; None for one that was not given."""
    attrs = result.attrs
    if key == "loading":
        return recorded_loading(result)
    if key == "initial":
        return _values_of(result, key, attributes.from_json(result, key, dict))
    if key == "parameter":
        return attributes.branch_parameter(result)
    if key == "method":
        return attributes.text(result, key)
    if key == "times":
        if key not in attrs:
            return None
        own = "t" in result.coords and "time" in result.coords["t"].dims
        return result.coords["t"].drop_vars("t") if own else result["time"].values
    if key == "V_start" and verb == "limit_cycle" and key not in attrs:
        return None
    if key in ("V_lp", "V_start", "t_end", "frequency"):
        follows = attrs.get("parameter") == key  # what a branch follows is between two ends
        return None if follows else _value_of(result, key, key, attributes.from_json(result, key))
    return attributes.number(result, key)


def _value_of(result: Any, name: str, symbol: str, recorded: Any) -> Any:
    """The value recorded in an attribute; of a swept one the cases that the result still has."""
    if not isinstance(recorded, dict):
        return attributes.parameter_value(name, symbol, recorded)
    if symbol == "frequency":
        found = result[symbol]
        return _without_case_labels(found if found.ndim else found.item())
    if symbol in result.coords and symbol not in ("V_start", "t_end"):
        return _without_case_labels(parameter(result, symbol))
    if isinstance(recorded.get("values"), str):  # too many for an attribute
        return _without_case_labels(result[symbol])
    return with_labels(result, attributes.array(name, recorded))


def _without_case_labels(value: Any) -> Any:
    """A value of a result, without scalar coordinates."""
    if not is_array(value):
        return value
    return value.drop_vars([name for name, label in value.coords.items() if not label.dims])


def _values_of(result: Any, name: str, given: dict[str, Any]) -> dict[str, Any]:
    """The values in an attribute, some of which may be swept."""
    return {
        k: with_labels(result, attributes.array(name, v)) if isinstance(v, dict) else v
        for k, v in given.items()
    }
