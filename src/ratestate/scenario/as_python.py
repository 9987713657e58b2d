"""Python lines from a scenario."""

import json
from typing import Any

import numpy as np

from ..friction.law_formula import HASH_MARK
from ..model.load_point import Call
from ..model.loading import Loading
from ..model.units import is_array
from ..model.user_laws import file_of_law
from .as_toml import is_own_axis, numbers, quantity
from .scenario import Scenario, check_scenario


def python(scenario: Scenario) -> str:
    """Return Python lines that run a scenario and assign its Dataset to ``result``.

    They include imports and reproduce the result bit-for-bit.  They print nothing and write no
    files, whatever the scenario's output is.  A user's law is registered from the file that it
    came from; for a law from a class a comment says what to do.

    Parameters
    ----------
    scenario : Scenario
        From `load`, `loads` or `from_result`.

    Returns
    -------
    str
        Lines of Python.
    """
    check_scenario(scenario)
    settings = dict(scenario.settings)
    parameters = scenario.slider.parameters.items()
    lines = [*registration(scenario.slider.law)]
    lines += [
        "slider = " + _call("rs.SpringSlider", [f"{k}={_value(k, v)}" for k, v in parameters])
    ]
    arguments = ["slider"]
    if "loading" in settings:
        lines += ["loading = " + _loading(settings.pop("loading"))]
        arguments.append("loading")
    arguments += [f"{key}={_setting(key, value)}" for key, value in settings.items()]
    lines.append("result = " + _call(f"rs.{scenario.function}", arguments, 70))
    text = "\n".join(lines)
    needed = [("xarray", "xarray."), ("ratestate as rs", "rs.")]
    imports = [f"import {name}" for name, used in needed if used in text]
    return "\n".join([*imports, "", text]) + "\n"


def registration(law: str) -> list[str]:
    """Return lines that make a user's law known: a comment if it has no file."""
    if HASH_MARK not in law:
        return []
    if file := file_of_law(law):
        return [f"rs.register({json.dumps(file.as_posix(), ensure_ascii=False)})"]
    return [f"# {law} is a user's law: register its class or its file first"]


def _call(name: str, arguments: list[str], longest: int = 0) -> str:
    """Return a call on one line if its arguments have this length, else one line each."""
    text = ", ".join(arguments)
    if len(text) <= longest and "\n" not in text:
        return f"{name}({text})"
    return f"{name}(\n" + "".join(f"    {argument},\n" for argument in arguments) + ")"


def _loading(loading: Loading) -> str:
    """Return the calls that make a loading."""
    first, *others = loading.calls
    calls = [_first(first), *(f".{call.method}({_arguments(call)})" for call in others)]
    if others and all(call.method == "step" for call in others):
        pairs = [f"({_arguments(call)})" for call in others]
        calls = [_call("rs.Loading.steps", [_value("V_lp", first.arguments["V_lp"]), *pairs], 61)]
    text = "".join(calls)
    if len(calls) == 1 or len(text) < 80:
        return text
    return "(\n" + "".join(f"    {call}\n" for call in calls) + ")"


def _first(call: Call) -> str:
    if call.method == "series":
        columns = call.arguments.items()
        texts = [f"{symbol}={_column(symbol, values)}" for symbol, values in columns]
        return _call("rs.Loading.series", texts)
    return f"rs.Loading.{call.method}({_arguments(call)})"


def _arguments(call: Call) -> str:
    """Return the arguments of a call, with the names of keyword-only arguments."""
    texts = ((name, _value(call.symbol(name), x)) for name, x in call.arguments.items())
    return ", ".join(f"{k}={x}" if k in ("period", "frequency", "t_end") else x for k, x in texts)


def _column(symbol: str, values: Any) -> str:
    if not is_array(values):
        return numbers(values)
    rows = [values.isel(segment=i, drop=True) for i in range(values.sizes["segment"])]
    return "[\n" + "".join(f"        {_value(symbol, row)},\n" for row in rows) + "    ]"


def _setting(key: str, value: Any) -> str:
    if key == "initial":
        return "{" + ", ".join(f'"{k}": {_value(k, v)}' for k, v in value.items()) + "}"
    if key in ("start", "stop"):
        return repr(value)  # in the SI unit of the parameter
    if not isinstance(value, np.ndarray):
        return _value(key, value)
    return numbers(value, " " * 8)


def _value(symbol: str, value: Any) -> str:
    """Return a literal of a text, a quantity, or an array with names."""
    if not is_array(value):
        return 'float("inf")' if value == np.inf else quantity(symbol, value)
    if is_own_axis(symbol, value):
        return f'xarray.DataArray({numbers(value.values, " " * 8)}, dims="{symbol}")'
    coords = {
        name: (c.dims, c.values.tolist())
        for name, c in value.coords.items()
        if set(c.dims) <= set(value.dims)
    }
    return f"xarray.DataArray({value.values.tolist()!r}, {coords!r}, {value.dims!r})"
