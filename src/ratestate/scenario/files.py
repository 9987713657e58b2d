"""From a file to a slider and the arguments of a verb."""

import dataclasses
import re
import tomllib
from pathlib import Path
from typing import Any

from ..errors import ParameterError
from ..loading import Loading
from ..slider import SpringSlider
from .problems import Problems, bare, one_of, shown
from .tables import SLIDER, missing, slider_table, sweep_table

TABLES = ("slider", "sweep")


@dataclasses.dataclass(frozen=True, eq=False)
class Scenario:
    """What a file asks for: ``verb(slider, **settings)``.

    Attributes
    ----------
    verb : str
        "limit_cycle", "simulate" or "stability".
    slider : SpringSlider
        With a DataArray for each parameter that is swept.
    settings : dict
        Keyword arguments of the verb, in SI; DataArrays likewise.
    """

    verb: str
    slider: SpringSlider
    settings: dict[str, Any]


def load(path: str | Path) -> Scenario:
    """Read a scenario file.

    Parameters
    ----------
    path : str or Path
        A TOML file with the tables [slider] and [sweep].

    Raises
    ------
    ParameterError
        The file cannot be read or used.  Every problem in it is a line of the message:
        ``[table] key: what is wrong, expected what, such as an example``.
    """
    parsed = _parsed(Path(path))
    problems = Problems()
    tables = _tables(parsed, problems)
    common = slider_table(tables["slider"], problems)
    missing("slider", SLIDER.required, tables["slider"].keys() | tables["sweep"].keys(), problems)
    verb, swept = sweep_table(tables["sweep"], problems)
    if problems:
        raise ParameterError("\n".join([f"{path} cannot be used:", *problems]))
    settings = common | swept
    slider = SpringSlider(**{key: settings.pop(key) for key in SLIDER.keys if key in settings})
    if verb == "simulate":
        settings["loading"] = Loading.constant(settings.pop("V_lp"))
    return Scenario(verb, slider, settings)


def _parsed(path: Path) -> dict[str, Any]:
    """What the file holds, as TOML has it."""
    try:
        text = path.read_bytes()
        return tomllib.loads(text.decode("utf-8-sig"))
    except OSError as error:
        raise ParameterError(f"{path} cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        k = text[: error.start].count(b"\n") + 1
        what = f"line {k} is not UTF-8, expected text"
    except RecursionError:
        what = "too many brackets inside each other, expected values"
    except tomllib.TOMLDecodeError as error:
        message, _, where = str(error).partition(" (at ")
        number = re.match(r"line (\d+)", where)
        lines = (text if number else text.rstrip()).decode().split("\n")
        k = int(number[1]) if number else len(lines)  # else it is the end of the document
        what = f"line {k}, {shown(lines[k - 1].strip())}: {message}, expected TOML"
    except ValueError:
        what = "an integer of thousands of digits, expected values"
    raise ParameterError(f'{path} is broken: {what} such as a = 0.003 or Dc = "10 um"')


def _tables(parsed: dict[str, Any], problems: Problems) -> dict[str, dict[str, Any]]:
    """The known tables, empty where missing."""
    tables: dict[str, dict[str, Any]] = {name: {} for name in TABLES}
    known = [f"[{name}]" for name in TABLES]
    for name, table in parsed.items():
        place = f"[{bare(name)}]"
        if not isinstance(table, dict):
            what = f"{shown(table)} is no table" if name in TABLES else "stands above all tables"
            problems.add(place if name in TABLES else bare(name), f"{what}, {one_of(known)}")
        elif name in TABLES:
            tables[name] = table
        else:
            problems.add(place, f"unknown table, {one_of(known, place)}")
    return tables
