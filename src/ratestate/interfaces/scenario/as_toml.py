"""A scenario as the text of a file."""

from pathlib import Path
from typing import Any

import numpy as np

from ...errors import ParameterError
from ...friction.law_formula import LOG, MARK
from ...model.history import NormalStress
from ...model.loading import Loading
from ...model.parameters import OTHER_QUANTITIES
from ...model.quantities import QUANTITIES
from ...model.units import is_array
from ...model.user_laws import file_of
from ...model.written import Event, events_of, has_stress_rows, rows_of, stress_events_of
from .literals import find_axis, is_own_axis, numbers, quantity
from .model import FUNCTIONS, Scenario


def toml(scenario: Scenario) -> str:
    """The text of a scenario file, from which `load` makes the same scenario, bit-for-bit.

    Parameters
    ----------
    scenario : Scenario
        From `load`, `loads` or `from_result`.

    Returns
    -------
    str
        TOML, in UTF-8 if written to a file.

    Raises
    ------
    ParameterError
        The scenario sweeps what a file cannot: an array along another dimension than its own.

    Notes
    -----
    A law that was registered from a file is named with the hash of its source, and its file by its
    whole path.
    Values whose magnitude `load` refuses (`scenario.values`) are written nevertheless; `load`
    then names them.
    """
    verb, slider, settings = scenario.verb, scenario.slider.parameters, dict(scenario.settings)
    loading: dict[str, str] = {}
    swept = {k: v for k, v in {**slider, **settings}.items() if is_array(v) and k != "frequency"}
    if "loading" in settings:
        history = settings.pop("loading")
        loading, last = _loading(history)
        if history.normal_stress is not None and not has_stress_rows(history):
            loading |= _normal_stress(history.normal_stress)
        swept |= {"V_lp": last} if is_array(last) else {}
    elif "V_lp" in settings and "V_lp" not in swept:
        loading = {"V_lp": quantity("V_lp", settings["V_lp"])}
    axes = {key: _axis(key, value) for key, value in swept.items()}
    if verb == "continue_cycle":
        symbol = settings["parameter"]
        ends = {"from": settings["start"], "to": settings["stop"]}
        axes[symbol] = _inline({key: quantity(symbol, end) for key, end in ends.items()})
    if verb == "limit_cycle" and axes and "V_start" in settings and "V_start" not in swept:
        axes["V_start"] = _literal("V_start", settings["V_start"])
    elsewhere = {"V_lp", "parameter", "start", "stop", *axes}
    run = {
        k: _axis(k, v) if is_array(v) else _literal(k, v)
        for k, v in settings.items()
        if k not in elsewhere
    }
    output = {"file": scenario.output.file, "plot": scenario.output.plot}
    named = {"verb": f'"{verb}"'}
    tables = {
        "slider": {k: _literal(k, v) for k, v in slider.items() if k not in swept}
        | _law(scenario.slider.law)
        | _form(scenario.slider.friction),
        "loading": loading,
        "run": run if axes or verb == "simulate" else named | run,
        "sweep": named | axes if axes else {},
        "output": {key: _literal(key, path) for key, path in output.items() if path},
    }
    lines = [f"# To do this: ratestate {FUNCTIONS[verb].commands[bool(swept)]} FILE.toml"]
    for name, table in tables.items():
        if table:
            lines += ["", f"[{name}]", *(f"{key} = {value}" for key, value in table.items())]
    return "\n".join(lines) + "\n"


def _law(name: str) -> dict[str, str]:
    """The keys for the friction law: with its file, if that is a user's."""
    if file := file_of(name):
        return {"law": _literal("law", name), "law_file": _literal("law_file", file)}
    unknown = "  # a user's: law_file names the file that has it" if MARK in name else ""
    return {"law": _literal("law", name) + unknown}


def _form(name: str) -> dict[str, str]:
    """The key for the form of friction, unless it is that of eq. 1."""
    return {} if name == LOG else {"friction": _literal("friction", name)}


def _loading(loading: Loading) -> tuple[dict[str, str], Any]:
    """The keys of [loading], and its last speed."""
    if (sine := loading.sine) is not None:
        _refuse_arrays("the amplitude of a sinusoid", sine.amplitude)
        first = last = sine.V_lp
        values = {"amplitude": ("V_lp", sine.amplitude), "period": ("period", sine.period)}
        more = {"sinusoid": _inline({key: quantity(*value) for key, value in values.items()})}
    elif np.isfinite(loading.t_last):
        t, V, sigma = rows_of(loading)
        _refuse_arrays("the speeds of a record", V)
        _refuse_arrays("the normal stress of a record", sigma)
        columns = {"t": f"{numbers(t)}  # s", "V_lp": f"{numbers(V)}  # m/s"}
        if sigma is not None:
            columns["sigma"] = f"{numbers(sigma)}  # Pa"
        return columns, V[-1]
    else:
        first, events = events_of(loading)
        *before, last = [first, *(event.value for event in events if event.value is not None)]
        if any(map(is_array, before)):
            raise ParameterError("a scenario file can sweep none but the last speed of a loading")
        steps = "".join(f"    {_step(event)},\n" for event in events)
        more = {"steps": f"[\n{steps}]"} if events else {}
    return ({} if is_array(first) else {"V_lp": quantity("V_lp", first)}) | more, last


def _normal_stress(stress: NormalStress) -> dict[str, str]:
    """The keys of [loading] that change the normal stress."""
    keys, steps = {}, []
    for event in stress_events_of(stress):
        _refuse_arrays("normal stress", event.value)
        values = {
            "t": ("t", event.t),
            "sigma": ("sigma", event.value),
            "ramp": ("t", event.duration),
        }
        steps.append(_inline({k: quantity(s, x) for k, (s, x) in values.items() if x is not None}))
    if steps:
        keys["sigma_steps"] = "[\n" + "".join(f"    {step},\n" for step in steps) + "]"
    if not np.all(np.isinf(stress.period)):
        _refuse_arrays("normal stress", stress.amplitude, stress.period)
        values = {"amplitude": ("sigma", stress.amplitude), "period": ("period", stress.period)}
        keys["sigma_sinusoid"] = _inline({key: quantity(*value) for key, value in values.items()})
    return keys


def _refuse_arrays(what: str, *values: Any) -> None:
    """Raise ParameterError for values that are swept."""
    if any(map(is_array, values)):
        raise ParameterError(
            f"{what} cannot be swept in a scenario file; "
            f"ratestate.scenario.python(scenario) writes this one as Python"
        )


def _step(event: Event) -> str:
    """A step, hold or ramp as an inline table."""
    V = 1.0 if is_array(event.value) else event.value  # a swept last speed is in [sweep]
    values = {"t": ("t", event.t), "V_lp": ("V_lp", V), event.kind: ("t", event.duration)}
    given = {key: (symbol, x) for key, (symbol, x) in values.items() if x is not None}
    return _inline({key: quantity(*value) for key, value in given.items()})


def _axis(symbol: str, value: Any) -> str:
    """The values of a swept parameter."""
    if not is_own_axis(symbol, value):
        ways = OTHER_QUANTITIES.get(symbol, {}).items()
        made_of = [f"{quantity} and {by}" for quantity, (_, by) in ways if by in value.dims]
        why = f", as it does if made of {' or of '.join(made_of)}" if made_of else ""
        raise ParameterError(
            f"{symbol} lies along {', '.join(map(str, value.dims))}{why}: a scenario file can "
            f"sweep a parameter along a dimension of its own only; "
            f"ratestate.scenario.python(scenario) writes this one as Python"
        )
    return _literal(symbol, value.values)


def _literal(key: str, value: Any) -> str:
    """A value: text, a table of initial values, an axis between two ends, a list, or a quantity."""
    if isinstance(value, str | Path):  # without control characters
        escaped = str(value).replace("\\", "\\\\").replace('"', '\\"')
        return f'"{escaped}"'
    if isinstance(value, dict):
        _refuse_arrays("initial values", *value.values())
        return _inline({symbol: quantity(symbol, x) for symbol, x in value.items()})
    if not isinstance(value, np.ndarray):
        return quantity(key, value)
    if axis := find_axis(key, value):
        ends = {"from": quantity(key, axis.first), "to": quantity(key, axis.last)}
        return _inline({**ends, "n": f"{axis.size}", "scale": f'"{axis.scale}"'})
    unit = QUANTITIES[key].unit
    return numbers(value) + ("" if unit == "1" else f"  # {unit}")


def _inline(literals: dict[str, str]) -> str:
    """An inline table."""
    return f"{{ {', '.join(f'{key} = {literal}' for key, literal in literals.items())} }}"
