"""The text of a scenario file from a scenario."""

import json
import textwrap
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import ParameterError
from ..friction.law_formula import HASH_MARK
from ..model.load_point import Call
from ..model.loading import Loading
from ..model.parameters import OTHER_QUANTITIES
from ..model.quantities import QUANTITIES, exact_text
from ..model.units import is_array
from ..model.user_laws import file_of_law
from .scenario import FUNCTIONS, Scenario, check_scenario

WIDTH = 93  # characters of a line
AS_PYTHON = "Write this scenario as Python, with ratestate.scenario.python(scenario)."


def toml(scenario: Scenario) -> str:
    """Return the text of a scenario file, from which `load` makes the same values, bit-for-bit.

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
        If the scenario sweeps something that a file cannot sweep: an array along a dimension that
        is not its own.

    Notes
    -----
    For a law that was registered from a file, the text has the absolute path of the file, and the
    name of the law includes the hash of its formula.  A law from a class must be registered again
    before `load`.  Unusually large or small values are written although `load` refuses them.
    """
    check_scenario(scenario)
    function, settings = scenario.function, dict(scenario.settings)
    slider = scenario.slider.parameters
    loading: dict[str, str] = {}
    swept = {k: v for k, v in {**slider, **settings}.items() if is_array(v) and k != "frequency"}
    if "loading" in settings:
        loading, last = _loading(settings.pop("loading"))
        swept |= {"V_lp": last} if is_array(last) else {}
    elif "V_lp" in settings and "V_lp" not in swept:
        loading = {"V_lp": quantity("V_lp", settings["V_lp"])}
    axes = {key: _axis(key, value) for key, value in swept.items()}
    if function == "continue_cycle":
        symbol = settings["parameter"]
        ends = {"from": settings["start"], "to": settings["stop"]}
        axes[symbol] = _inline({key: quantity(symbol, end) for key, end in ends.items()})
    if function == "limit_cycle" and axes and "V_start" in settings and "V_start" not in swept:
        axes["V_start"] = _literal("V_start", settings["V_start"])
    other_keys = {"V_lp", "parameter", "start", "stop", *axes}
    run = {
        k: _axis(k, v) if is_array(v) else _literal(k, v)
        for k, v in settings.items()
        if k not in other_keys
    }
    output = {"file": scenario.output.file, "plot": scenario.output.plot}
    named = {"function": f'"{function}"'}
    tables = {
        "slider": {k: _literal(k, v) for k, v in slider.items() if k not in swept}
        | _law(scenario.slider.law),
        "loading": loading,
        "run": run if axes or function == "simulate" else named | run,
        "sweep": named | axes if axes else {},
        "output": {key: _literal(key, path) for key, path in output.items() if path},
    }
    lines = [f"# To do this: ratestate {FUNCTIONS[function].commands[bool(swept)]} FILE.toml"]
    for name, table in tables.items():
        if table:
            lines += ["", f"[{name}]", *(f"{key} = {value}" for key, value in table.items())]
    return "\n".join(lines) + "\n"


def _law(name: str) -> dict[str, str]:
    if file := file_of_law(name):
        return {"law": _literal("law", name), "law_file": _literal("law_file", file)}
    unknown = "  # a user's: law_file names the file that has it" if HASH_MARK in name else ""
    return {"law": _literal("law", name) + unknown}


def _loading(loading: Loading) -> tuple[dict[str, str], Any]:
    """Return the keys of [loading], and its last speed."""
    first, *events = (call for call in loading.calls if not call.changes_stress)
    values = first.arguments
    stress = _normal_stress([call for call in loading.calls if call.changes_stress])
    if first.method == "series":
        _refuse_arrays("the speeds of a record", values["V_lp"])
        _refuse_arrays("the normal stress of a record", values.get("sigma"))
        columns = {symbol: _literal(symbol, column) for symbol, column in values.items()}
        return columns | stress, values["V_lp"][-1]
    if first.method == "sinusoid":
        _refuse_arrays("the amplitude of a sinusoid", values["amplitude"])
        speeds, entries = [values["V_lp"]], {"sinusoid": _table(first)}
    else:
        given = values, *(event.arguments for event in events)
        speeds = [arguments["V_lp"] for arguments in given if "V_lp" in arguments]
        if any(map(is_array, speeds[:-1])):
            raise ParameterError(
                "a scenario file can sweep only the last speed of a loading", AS_PYTHON
            )
        steps = [_table(call, duration=call.method) for call in events]
        entries = {"steps": _lines(steps)} if steps else {}
    if not is_array(speeds[0]):
        entries = {"V_lp": quantity("V_lp", speeds[0])} | entries
    return entries | stress, speeds[-1]


def _normal_stress(calls: list[Call]) -> dict[str, str]:
    """Return the keys of [loading] that change the normal stress."""
    for call in calls:
        _refuse_arrays("normal stress", *call.arguments.values())
    steps = [_table(call, duration="ramp") for call in calls if call.method != "sigma_sinusoid"]
    waves = [_table(call) for call in calls if call.method == "sigma_sinusoid"]
    keys = {"sigma_steps": _lines(steps)} if steps else {}
    return keys | ({"sigma_sinusoid": waves[0]} if waves else {})


def _table(call: Call, **keys: str) -> str:
    """Return an inline table of a call's arguments; keys replaces their names."""
    literals = {
        # the swept last speed is in [sweep]
        keys.get(name, name): quantity(call.symbol(name), 1.0 if is_array(value) else value)
        for name, value in call.arguments.items()
        if call.method != "sinusoid" or name not in ("V_lp", "t_end")
    }
    return _inline(literals)


def _lines(tables: list[str]) -> str:
    return "[\n" + "".join(f"    {table},\n" for table in tables) + "]"


def _refuse_arrays(subject: str, *values: Any) -> None:
    """Raise ParameterError for values that are swept."""
    if any(map(is_array, values)):
        raise ParameterError(f"{subject} cannot be swept in a scenario file", AS_PYTHON)


def _axis(symbol: str, value: Any) -> str:
    """Return the values of a swept parameter."""
    if not is_own_axis(symbol, value):
        ways = OTHER_QUANTITIES.get(symbol, {}).items()
        made_of = [f"{quantity} and {key}" for quantity, (_, key) in ways if key in value.dims]
        why = f", as it does if made of {' or of '.join(made_of)}" if made_of else ""
        raise ParameterError(
            f"{symbol} lies along {', '.join(map(str, value.dims))}{why}, but in a scenario file "
            "each swept parameter needs a dimension of its own",
            AS_PYTHON,
        )
    return _literal(symbol, value.values)


def _literal(key: str, value: Any) -> str:
    """Return a literal of a text, a table of initial values, a list, or a quantity."""
    if isinstance(value, str | Path):
        return json.dumps(str(value), ensure_ascii=False)
    if isinstance(value, dict):
        _refuse_arrays("initial values", *value.values())
        return _inline({symbol: quantity(symbol, x) for symbol, x in value.items()})
    if not isinstance(value, np.ndarray):
        return quantity(key, value)
    unit = QUANTITIES[key].unit
    return numbers(value) + ("" if unit == "1" else f"  # {unit}")


def _inline(literals: dict[str, str]) -> str:
    return f"{{ {', '.join(f'{key} = {literal}' for key, literal in literals.items())} }}"


def quantity(symbol: str, value: float | str) -> str:
    """Return a value as a literal of both TOML and Python, which is read back to the same bits.

    A text stays as it is.  A number in SI becomes a text with a unit if it has one.  Only TOML
    reads the literal of an infinite number.
    """
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if not np.isfinite(value):
        return repr(float(value))
    text = exact_text(symbol, value)
    return text if QUANTITIES[symbol].unit == "1" else f'"{text}"'


def numbers(values: Iterable[float], indent: str = "    ") -> str:
    """Return a list of numbers, on several lines if it is long, for both TOML and Python."""
    literals = [repr(float(x)) for x in values]
    if sum(map(len, literals)) + 2 * len(literals) <= 70:
        return f"[{', '.join(literals)}]"
    line = "".join(f"{literal}, " for literal in literals)
    lines = textwrap.wrap(
        line, WIDTH, initial_indent=indent, subsequent_indent=indent, break_on_hyphens=False
    )
    return "\n".join(["[", *lines, "]"])


def is_own_axis(symbol: str, value: Any) -> bool:
    """Return whether an array lies along a dimension of its own name, without other labels."""
    if not is_array(value) or value.dims != (symbol,):
        return False
    labels = value.coords.get(symbol)
    is_coordinate = labels is None or (labels.dims == (symbol,) and np.array_equal(labels, value))
    return bool(is_coordinate and not value.coords.keys() - {symbol})
