"""A scenario as the text of a file."""

from pathlib import Path
from typing import Any

import numpy as np

from ...errors import ParameterError
from ...friction.law_formula import HASH_MARK, LOG
from ...model.load_point import Call
from ...model.loading import Loading
from ...model.parameters import OTHER_QUANTITIES
from ...model.quantities import QUANTITIES
from ...model.units import is_array
from ...model.user_laws import file_of_law
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
        loading, last = _loading(settings.pop("loading"))
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
    if file := file_of_law(name):
        return {"law": _literal("law", name), "law_file": _literal("law_file", file)}
    unknown = "  # a user's: law_file names the file that has it" if HASH_MARK in name else ""
    return {"law": _literal("law", name) + unknown}


def _form(name: str) -> dict[str, str]:
    """The key for the form of friction, unless it is that of eq. 1."""
    return {} if name == LOG else {"friction": _literal("friction", name)}


def _loading(loading: Loading) -> tuple[dict[str, str], Any]:
    """The keys of [loading], and its last speed."""
    first, *events = (call for call in loading.calls if not call.changes_stress)
    values = first.arguments
    stress = _normal_stress([call for call in loading.calls if call.changes_stress])
    if first.method == "series":
        _refuse_arrays("the speeds of a record", values["V_lp"])
        _refuse_arrays("the normal stress of a record", values.get("sigma"))
        columns = {
            symbol: f"{numbers(column)}  # {QUANTITIES[symbol].unit}"
            for symbol, column in values.items()
        }
        return columns | stress, values["V_lp"][-1]
    if first.method == "sinusoid":
        _refuse_arrays("the amplitude of a sinusoid", values["amplitude"])
        speeds = [values["V_lp"]]
        more = {"sinusoid": _table(first, {"amplitude": "amplitude", "period": "period"})}
    else:
        speeds = [call.arguments["V"] for call in (first, *events) if "V" in call.arguments]
        if any(map(is_array, speeds[:-1])):
            raise ParameterError(
                "a scenario file can sweep no speed of a loading but the last one",
                "Write this scenario as Python, with ratestate.scenario.python(scenario).",
            )
        steps = [_table(call, {"t": "t", "V": "V_lp", "duration": call.method}) for call in events]
        more = {"steps": _lines(steps)} if steps else {}
    if not is_array(speeds[0]):
        more = {"V_lp": quantity("V_lp", speeds[0])} | more
    return more | stress, speeds[-1]


def _normal_stress(calls: list[Call]) -> dict[str, str]:
    """The keys of [loading] that change the normal stress."""
    keys, steps = {}, []
    for call in calls:
        _refuse_arrays("normal stress", *call.arguments.values())
        if call.method == "sigma_sinusoid":
            names = {name: name for name in call.arguments}
            keys["sigma_sinusoid"] = _table(call, names)
        else:
            steps.append(_table(call, {"t": "t", "sigma": "sigma", "duration": "ramp"}))
    return ({"sigma_steps": _lines(steps)} if steps else {}) | keys


def _table(call: Call, keys: dict[str, str]) -> str:
    """An inline table of arguments of a call, under these keys."""
    given = {name: key for name, key in keys.items() if name in call.arguments}
    values = {name: call.arguments[name] for name in given}
    literals = {
        # (a swept last speed is in [sweep])
        key: quantity(call.symbol(name), 1.0 if is_array(values[name]) else values[name])
        for name, key in given.items()
    }
    return _inline(literals)


def _lines(tables: list[str]) -> str:
    """A list with a table on each line."""
    return "[\n" + "".join(f"    {table},\n" for table in tables) + "]"


def _refuse_arrays(what: str, *values: Any) -> None:
    """Raise ParameterError for values that are swept."""
    if any(map(is_array, values)):
        raise ParameterError(
            f"{what} cannot be swept in a scenario file",
            "Write this scenario as Python, with ratestate.scenario.python(scenario).",
        )


def _axis(symbol: str, value: Any) -> str:
    """The values of a swept parameter."""
    if not is_own_axis(symbol, value):
        ways = OTHER_QUANTITIES.get(symbol, {}).items()
        made_of = [f"{quantity} and {by}" for quantity, (_, by) in ways if by in value.dims]
        why = f", as it does if made of {' or of '.join(made_of)}" if made_of else ""
        raise ParameterError(
            (
                f"{symbol} lies along {', '.join(map(str, value.dims))}{why}, but a scenario "
                "file can sweep a parameter along a dimension of its own only"
            ),
            "Write this scenario as Python, with ratestate.scenario.python(scenario).",
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
