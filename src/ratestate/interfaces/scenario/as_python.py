"""A scenario as Python lines."""

from typing import Any

import numpy as np

from ...model.loading import Loading
from ...model.loading.written import events_of, rows_of
from ...model.units import is_array
from .literals import find_axis, is_own_axis, numbers, quantity
from .model import Scenario


def python(scenario: Scenario) -> str:
    """Python lines that run a scenario and assign its Dataset to ``result``.

    They are complete, imports included, and reproduce the result bit-for-bit.
    """
    lines = ["slider = rs.SpringSlider("]
    for symbol, value in scenario.slider.parameters.items():
        lines.append(f"    {symbol}={_value(symbol, value)},")
    lines.append(")")
    settings = dict(scenario.settings)
    arguments = ["slider"]
    if "loading" in settings:
        lines += ["loading = " + _loading(settings.pop("loading"))]
        arguments.append("loading")
    arguments += [f"{key}={_setting(key, value)}" for key, value in settings.items()]
    call = ", ".join(arguments)
    if len(call) > 70 or "\n" in call:
        call = "\n" + "".join(f"    {argument},\n" for argument in arguments)
    lines.append(f"result = rs.{scenario.verb}({call})")
    text = "\n".join(lines)
    needed = [("numpy as np", "np."), ("xarray", "xarray."), ("ratestate as rs", "rs.")]
    imports = [f"import {name}" for name, used in needed if used in text]
    return "\n".join([*imports, "", text]) + "\n"


def _loading(loading: Loading) -> str:
    """The call that makes a loading."""
    if (sine := loading.sine) is not None:
        V_lp, amplitude = _value("V_lp", sine.V_lp), _value("V_lp", sine.amplitude)
        period, t_end = quantity("t", sine.period), quantity("t", loading.t_last)
        return f"rs.Loading.sinusoid({V_lp}, {amplitude}, period={period}, t_end={t_end})"
    if np.isfinite(loading.t_last):
        t, V = rows_of(loading)
        columns = f"t={numbers(t)},\n    V_lp={_column(V)},"
        return f"rs.Loading.series(\n    {columns}\n)"
    start, events = events_of(loading)
    if events and all(event.kind == "step" for event in events):
        pairs = [f"({quantity('t', e.t)}, {_value('V_lp', e.V)})" for e in events]
        return _call("rs.Loading.steps", [_value("V_lp", start), *pairs])
    calls = [f"rs.Loading.constant({_value('V_lp', start)})"]
    for event in events:
        arguments = [quantity("t", event.t)]
        arguments += [] if event.V is None else [_value("V_lp", event.V)]
        arguments += [] if event.duration is None else [quantity("t", event.duration)]
        calls.append(f".{event.kind}({', '.join(arguments)})")
    text = "".join(calls)
    return text if len(text) < 80 else "(\n" + "".join(f"    {call}\n" for call in calls) + ")"


def _call(name: str, arguments: list[str]) -> str:
    """A call on one line or, if it is long, with one argument on each line."""
    text = f"{name}({', '.join(arguments)})"
    if len(text) < 80 and "\n" not in text:
        return text
    return f"{name}(\n" + "".join(f"    {argument},\n" for argument in arguments) + ")"


def _column(V: Any) -> str:
    """The speeds of a record."""
    if not is_array(V):
        return numbers(V)
    rows = [V.isel(segment=i, drop=True) for i in range(V.sizes["segment"])]
    return "[\n" + "".join(f"        {_value('V_lp', row)},\n" for row in rows) + "    ]"


def _setting(key: str, value: Any) -> str:
    """An argument of the function."""
    if key == "times" and not is_array(value):
        return _times(value)
    if key == "initial":
        return "{" + ", ".join(f'"{k}": {_value(k, v)}' for k, v in value.items()) + "}"
    if key in ("start", "stop"):
        return repr(value)  # in SI; which unit that is says the parameter
    return _value(key, value)


def _times(times: np.ndarray) -> str:
    """Saved times: a call of linspace if they are evenly spaced, else a list."""
    ends = f"{float(times[0])!r}, {float(times[-1])!r}, {times.size}"
    even = np.linspace(times[0], times[-1], times.size)
    if times.size > 2 and np.array_equal(even, times):
        return f"np.linspace({ends})"
    if times.size > 2 and np.array_equal(even.round(12), times):
        return f"np.linspace({ends}).round(12)"
    return numbers(times, " " * 8)


def _value(symbol: str, value: Any) -> str:
    """A value: string, quantity, or array with names."""
    if isinstance(value, str):
        return f'"{value}"'
    if not is_array(value):
        return quantity(symbol, value) if np.isfinite(value) else 'float("inf")'
    if is_own_axis(symbol, value):
        axis = find_axis(symbol, value.values)
        if axis is not None and axis.scale == "log":
            first, last = quantity(symbol, axis.first), quantity(symbol, axis.last)
            return f'rs.logspace("{symbol}", {first}, {last}, {axis.n})'
        return f'xarray.DataArray({numbers(value.values, " " * 8)}, dims="{symbol}")'
    coords = {
        name: (c.dims, c.values.tolist())
        for name, c in value.coords.items()
        if set(c.dims) <= set(value.dims)
    }
    return f"xarray.DataArray({value.values.tolist()!r}, {coords!r}, {value.dims!r})"
