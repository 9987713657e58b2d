"""Values that a result records in its attributes, with the cases that the result still has."""

from typing import Any

from ...dynamics import attributes
from ...dynamics.recorded_loading import with_labels
from ...dynamics.results import parameter
from ...model.units import is_array

WANTED = (
    "give a Dataset as a function of ratestate returned it, or read from the file it was kept in"
)


def value_of(result: Any, name: str, symbol: str, recorded: Any) -> Any:
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


def values_of(result: Any, name: str, given: dict[str, Any]) -> dict[str, Any]:
    """The values in an attribute, some of which may be swept."""
    return {
        k: with_labels(result, attributes.array(name, v)) if isinstance(v, dict) else v
        for k, v in given.items()
    }
