"""A scenario as the text of a file."""

from typing import Any

import numpy as np

from ...errors import ParameterError
from ...model.loading import Loading
from ...model.loading.written import Event, events_of, rows_of
from ...model.quantities import QUANTITIES
from ...model.units import is_array
from .literals import find_axis, is_own_axis, numbers, quantity
from .model import Scenario

#: function -> the commands that call it, for one case and for many
COMMANDS = {
    "simulate": ("run", "sweep"),
    "limit_cycle": ("cycle", "sweep"),
    "stability": ("stability", "sweep"),
    "continue_cycle": ("branch", "branch"),
}


def toml(scenario: Scenario) -> str:
    """The text of a scenario file, from which `load` makes the same scenario, bit-for-bit.

    Raises
    ------
    ParameterError
        The scenario sweeps what a file cannot: an array along another dimension than its own.

    Notes
    -----
    Values whose magnitude `load` refuses (`scenario.magnitudes`) are written nevertheless; `load`
    then names them.
    """
    settings, slider = dict(scenario.settings), scenario.slider.parameters
    swept = {k: v for k, v in slider.items() if is_array(v)}
    swept |= {k: v for k, v in settings.items() if is_array(v)}
    tables: dict[str, list[str]] = {}
    tables["slider"] = [
        f"{symbol} = " + (f'"{value}"' if symbol == "law" else quantity(symbol, value))
        for symbol, value in slider.items()
        if symbol not in swept
    ]
    loading = settings.pop("loading", None)
    if loading is not None:
        tables["loading"], last = _loading(loading)
        swept |= {} if last is None else {"V_lp": last}
    elif "V_lp" in settings and "V_lp" not in swept:
        tables["loading"] = [f"V_lp = {quantity('V_lp', settings['V_lp'])}"]
    branch = scenario.verb == "continue_cycle"
    many = bool(swept) or branch
    verb = [f'verb = "{scenario.verb}"']
    tables["run"] = [] if many or scenario.verb == "simulate" else verb
    tables["run"] += [
        f"{key} = {_setting(key, value)}"
        for key, value in settings.items()
        if key not in {"V_lp", "parameter", "start", "stop", *swept}
    ]
    tables["sweep"] = verb * many + [f"{k} = {_axis(k, v)}" for k, v in swept.items()]
    if branch:
        tables["sweep"].append(_branch(settings))
    given = {"file": scenario.output.file, "plot": scenario.output.plot}
    tables["output"] = [f"{key} = {_text(str(path))}" for key, path in given.items() if path]
    command = COMMANDS[scenario.verb][bool(swept)]
    lines = [f"# To do this: ratestate {command} FILE.toml"]
    for name, content in tables.items():
        lines += ["", f"[{name}]", *content] if content else []
    return "\n".join(lines) + "\n"


def _loading(loading: Loading) -> tuple[list[str], Any]:
    """The lines of [loading], and the last speed if it is swept, else None."""
    if loading.sine is not None:
        sine = loading.sine
        if is_array(sine.amplitude):
            raise ParameterError("the amplitude of a sinusoid cannot be swept in a scenario file")
        amplitude, period = quantity("V_lp", sine.amplitude), quantity("t", sine.period)
        line = f"sinusoid = {{ amplitude = {amplitude}, period = {period} }}"
        return (
            ([line], sine.V_lp)
            if is_array(sine.V_lp)
            else ([f"V_lp = {quantity('V_lp', sine.V_lp)}", line], None)
        )
    if np.isfinite(loading.t_last):
        t, V = rows_of(loading)
        if is_array(V):
            raise ParameterError("the speeds of a record cannot be swept in a scenario file")
        return [f"t = {numbers(t)}  # s", f"V_lp = {numbers(V)}  # m/s"], None
    start, events = events_of(loading)
    steps = [Event("step", 0.0, start), *events]
    final = max(i for i, step in enumerate(steps) if step.V is not None)
    swept = [i for i, step in enumerate(steps) if is_array(step.V)]
    if not set(swept) <= {final}:
        raise ParameterError("a scenario file can sweep none but the last speed of a loading")
    last = steps[final].V if swept else None
    lines = [] if final == 0 and swept else [f"V_lp = {quantity('V_lp', start)}"]
    # a swept last speed is in [sweep], and here replaced by 1 m/s
    steps_lines = [_step(step, 1.0 if is_array(step.V) else step.V) for step in events]
    return lines + (
        ["steps = [", *(f"    {step}," for step in steps_lines), "]"] if steps_lines else []
    ), last


def _step(event: Event, V: float | None) -> str:
    """A step, hold or ramp as an inline table."""
    keys = [f"t = {quantity('t', event.t)}"]
    keys += [] if V is None else [f"V_lp = {quantity('V_lp', V)}"]
    if event.duration is not None:
        keys.append(f"{event.kind} = {quantity('t', event.duration)}")
    return f"{{ {', '.join(keys)} }}"


def _setting(key: str, value: Any) -> str:
    """The value of a key of [run]."""
    if key == "times":
        if is_array(value):
            raise ParameterError("times of each case cannot stand in a scenario file")
        return _values(key, value)
    if key == "initial":
        if any(map(is_array, value.values())):
            raise ParameterError("initial values cannot be swept in a scenario file")
        return f"{{ {', '.join(f'{k} = {quantity(k, v)}' for k, v in value.items())} }}"
    return f'"{value}"' if isinstance(value, str) else quantity(key, value)


def _axis(symbol: str, value: Any) -> str:
    """The values of a swept parameter."""
    if not is_own_axis(symbol, value):
        raise ParameterError(
            f"{symbol} lies along {', '.join(map(str, value.dims))}: a scenario file can sweep a "
            f"parameter along a dimension of its own only"
        )
    return _values(symbol, value.values)


def _values(symbol: str, values: np.ndarray) -> str:
    """Many values: an axis between two ends, or a list of numbers in SI."""
    if axis := find_axis(symbol, values):
        first, last = quantity(symbol, axis.first), quantity(symbol, axis.last)
        return f'{{ from = {first}, to = {last}, n = {axis.n}, scale = "{axis.scale}" }}'
    unit = QUANTITIES[symbol].unit
    return numbers(values) + ("" if unit == "1" else f"  # {unit}")


def _branch(settings: dict[str, Any]) -> str:
    """The parameter that a branch follows, between its ends."""
    symbol = settings["parameter"]
    first, last = quantity(symbol, settings["start"]), quantity(symbol, settings["stop"])
    return f"{symbol} = {{ from = {first}, to = {last} }}"


def _text(text: str) -> str:
    """A text as TOML has it; paths hold no control characters."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
