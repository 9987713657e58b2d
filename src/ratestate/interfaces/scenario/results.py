"""The scenario that made a result, from the attributes of the result."""

import dataclasses
import inspect
from typing import Any

import numpy as np
import xarray

from ...dynamics import attributes
from ...dynamics.results import parameter
from ...errors import ParameterError
from ...friction.forms import parameters_of
from ...friction.law import LOG
from ...friction.laws import DEFAULT, friction_law, known_law
from ...friction.user_law import MARK
from ...model.conversion import in_si
from ...model.loading import Loading
from ...model.loading.normal_stress import NormalStress
from ...model.loading.shapes import SHAPES
from ...model.slider import OPTIONAL, SpringSlider
from ...model.units import is_array
from .known_keys import COMMON
from .model import FUNCTIONS, Scenario

WANTED = "give a Dataset as a verb of ratestate returned it, or read from the file it was kept in"

#: how far a speed at the end of a segment may fall below 0, relative to the largest speed
ROUNDING = 1e-9


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
        raise ParameterError(f"{type(result).__name__} is no result; {WANTED}")
    result = in_si(result)
    title = str(result.attrs.get("title", ""))
    verb = title.removeprefix("ratestate ")
    if title == "ratestate fit":
        raise ParameterError(
            "the result is a fit, of which there is no scenario: fit the record again with "
            "ratestate fit, or with the lines of Python in its report.md; to go on with the slider "
            "that it found, take ratestate.fitting.slider_of(result)"
        )
    if verb not in FUNCTIONS or not title.startswith("ratestate "):
        raise ParameterError(f"the result's title is {title[:60]!r}, which is no verb's; {WANTED}")
    try:
        scenario = Scenario(verb, _slider(result), _settings(verb, result))
        _check(scenario)
    except ParameterError:
        raise
    except Exception as error:  # variables too may be gone, or others than they were
        raise ParameterError(
            f"what made this {verb} is not all there ({type(error).__name__}: {error}); {WANTED}"
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
    if isinstance(law, str) and MARK in law and not known_law(law):
        raise ParameterError(_unknown_law(law))
    of_law = friction_law(law).parameters.keys() | parameters_of(values.get("friction", LOG)).keys()
    wanted = COMMON.keys() | of_law
    if odd := (wanted ^ values.keys()) - {*OPTIONAL}:
        raise ParameterError(
            f"the attribute 'slider' of the Dataset lacks, or has beside what it should, "
            f"{', '.join(sorted(odd))[:100]}; {WANTED}"
        )
    followed = result.attrs.get("parameter")
    swept = {k: _swept(result, "slider", k, v) for k, v in values.items() if k != followed}
    return SpringSlider(**values | swept)


def _unknown_law(law: str) -> str:
    """What to do about a user's law that is not known."""
    own = law.partition(MARK)[0]
    text = (
        f"the result is of the law {law!r}, a user's own that is not known here: give its file, "
        f"--law-file {own}.py or ratestate.register('{own}.py')"
    )
    if other := known_law(own):
        text += f"; the {own} that is known is {other!r}, from another source, as of an edited file"
    return text


def _swept(result: Any, name: str, symbol: str, recorded: Any) -> Any:
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
    return _labelled(result, attributes.array(name, recorded))


def _without_case_labels(value: Any) -> Any:
    """A value of a result, without scalar coordinates."""
    if not is_array(value):
        return value
    return value.drop_vars([name for name, label in value.coords.items() if not label.dims])


def _labelled(result: Any, recorded: Any) -> Any:
    """A recorded array over some of the result's dimensions, with the result's labels."""
    for dim, size in recorded.sizes.items():
        if dim != "segment" and result.sizes.get(dim) != size:
            raise ParameterError(
                f"the result holds {result.sizes.get(dim, 1)} of {size} cases along {dim!r}, and "
                f"does not say which; give all of them"
            )
    coords = {
        name: c.variable
        for name, c in result.coords.items()
        if set(c.dims) <= set(recorded.dims) and c.dims and name != "time"
    }
    return recorded.drop_vars(recorded.coords).assign_coords(coords)


def _values(result: Any, name: str, given: dict[str, Any]) -> dict[str, Any]:
    """The values in an attribute, some of which may be swept."""
    return {
        k: _labelled(result, attributes.array(name, v)) if isinstance(v, dict) else v
        for k, v in given.items()
    }


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
        return _loading(result)
    if key == "initial":
        return _values(result, key, attributes.from_json(result, key, dict))
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
        return None if follows else _swept(result, key, key, attributes.from_json(result, key))
    return attributes.number(result, key) if key != "dt" or key in attrs else None


def _loading(result: Any) -> Loading:
    """The load-point history that a result records, and that of normal stress."""
    record = attributes.loading_record(result)
    loading = _speeds(result, record)
    if "sigma" not in record:
        return loading
    return dataclasses.replace(loading, normal_stress=_normal_stress(result, record["sigma"]))


def _speeds(result: Any, record: dict[str, Any]) -> Loading:
    """The history of speeds that a result records."""
    t_last = np.inf if record["t_last"] is None else float(record["t_last"])
    for kind in SHAPES.keys() & record.keys():
        return getattr(Loading, kind)(**_values(result, "loading", record[kind]), t_end=t_last)
    t, V, rate = (
        _column(result, record, name, "loading_", "segment") for name in ("t", "V", "rate")
    )
    if not _is_history(t, np.asarray(V), np.asarray(rate), t_last):
        raise ParameterError(f"the loading that the Dataset records is no history; {WANTED}")
    return Loading(t, V, rate, t_last)


def _normal_stress(result: Any, record: Any) -> NormalStress:
    """The history of normal stress that a result records."""
    wave = {"amplitude": 0.0, "period": np.inf}
    if not isinstance(record, dict):
        raise ParameterError(f"the normal stress that the Dataset records is none; {WANTED}")
    given = {name: x for name, x in record.items() if name in wave}
    names = "t", "start", "end"
    t, start, end = (
        _column(result, record, name, "loading_sigma_", "segment_of_sigma") for name in names
    )
    shapes = {np.shape(start), np.shape(end)}
    sound = t.ndim == 1 and t.size and len(shapes) == 1 and np.shape(start)[-1:] == t.shape
    if not sound or t[0] != 0.0 or not (np.diff(t) > 0.0).all():
        raise ParameterError(f"the normal stress that the Dataset records is none; {WANTED}")
    if not all(
        np.greater(column, 0.0)[np.isfinite(column)].all()
        for column in map(np.asarray, (start, end))
    ):
        raise ParameterError(f"the normal stress that the Dataset records is not > 0; {WANTED}")
    ends_ramp = t.size > 1 and bool(np.any(np.not_equal(start[..., -2], end[..., -2])))
    wave |= _values(result, "loading", given)
    return NormalStress(t, start, end, **wave, returns=ends_ramp)


def _column(result: Any, record: dict[str, Any], name: str, prefix: str, dim: str) -> Any:
    """A column of a history, from the record or a variable of the result; NaN for null."""
    value: Any = record[name] if name in record else result[prefix + name].variable
    if isinstance(value, dict):
        value = attributes.array("loading", value)
    if np.ndim(value) <= 1:
        return np.array(value, float)
    array = xarray.DataArray(value).astype(float)
    return _labelled(result, array.rename({dim: "segment"} if dim in array.dims else {}))


def _is_history(t: Any, V: Any, rate: Any, t_last: float) -> bool:
    """Whether these can be the fields of a `Loading`: times that increase, speeds >= 0."""
    if not (t.ndim == 1 and t.size and V.shape == rate.shape and V.shape[-1:] == t.shape):
        return False
    lasts = np.diff(t, append=t_last)
    with np.errstate(invalid="ignore", over="ignore"):
        ends = V + np.where(rate == 0.0, 0.0, rate * lasts)
    return bool(
        (t[0] == 0.0 and (lasts > 0.0).all())
        and all(np.isfinite(column).all() for column in (t, V, ends))
        and (V >= 0.0).all()
        and (ends >= -ROUNDING * V.max()).all()
    )
