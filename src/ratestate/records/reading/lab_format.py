"""A laboratory's format, saved as TOML: what `read_lab` cannot detect in its files."""

import dataclasses
import json
import tomllib
from pathlib import Path
from typing import Any

from ...errors import ParameterError
from ...model.names import keywords_checked, one_of
from ...model.parameters import WHOLE_CONTACT, quantity_of
from ...model.quantities import QUANTITIES
from ...model.units import has_unit, to_si
from ..messages import reading as sentences
from .assembly import build_record
from .columns import check_requests, choose_columns
from .open_table import as_file, open_table
from .text import DELIMITERS
from .titles import EXAMPLE_UNIT, plain_unit

MAX_BYTES = 100_000  # bytes
#: delimiter in a description -> delimiter for `read_text`
DELIMITER_NAMES = {"tab": "\t", ";": ";", ",": ",", "space": None}
DECIMALS = (".", ",")
HEAD = """\
# How the files of a laboratory are read, found in {source}:
#     ratestate fit FILE --lab-format THIS_FILE
#     ratestate.read_lab(file, lab_format="THIS_FILE")
# Arguments of a call have precedence over the values here.
"""
#: table -> its keys, its comment, and example lines for a description without values
TABLES: dict[str, tuple[tuple[str, ...], str, dict[str, Any]]] = {
    "text": (
        ("delimiter", "decimal"),
        'Only if it is not detected: the delimiter ("tab", ",", ";" or "space") and the decimal '
        'mark\n# ("." or ",").',
        {"delimiter": ";", "decimal": ","},
    ),
    "columns": (
        tuple(EXAMPLE_UNIT),
        "The title of each column that is read, or its number, counted from 1.",
        {},
    ),
    "units": (
        tuple(EXAMPLE_UNIT),
        "Units of columns whose unit in the file is missing or wrong.",
        {},
    ),
    "constants": (("sigma",), "Normal stress if it is not recorded.", {"sigma": "20 MPa"}),
    "signs": (
        tuple(symbol for symbol in EXAMPLE_UNIT if symbol != "time"),
        "-1: the sign in the file is changed, 1: it is kept.  The sign of other columns is changed "
        "if\n# stress or friction is negative throughout, or if the load point moves backwards.",
        {"delta_lp": -1},
    ),
    "machine": (
        ("K", "M"),
        "Stiffness (per area of the contact, or friction per length) and mass (per area) of the "
        "machine.",
        {"K": "1 GPa/m", "M": "3000 kg/m^2"},
    ),
}


@dataclasses.dataclass(frozen=True)
class LabFormat:
    """The tables of a description of a laboratory's files."""

    text: dict[str, str] = dataclasses.field(default_factory=dict)
    columns: dict[str, Any] = dataclasses.field(default_factory=dict)
    units: dict[str, str] = dataclasses.field(default_factory=dict)
    constants: dict[str, Any] = dataclasses.field(default_factory=dict)
    signs: dict[str, int] = dataclasses.field(default_factory=dict)
    machine: dict[str, Any] = dataclasses.field(default_factory=dict)

    def with_arguments(self, columns, units, sigma=None):
        """Combine the format with the arguments of a call, which have precedence.

        columns, units, sigma : as for `read_lab`; ParameterError if they are not valid
        """
        columns, units = {} if columns is None else columns, {} if units is None else units
        check_requests(columns, units)
        sigma = self.constants.get("sigma") if sigma is None else sigma
        saved, constants = [self.columns, self.units], {}
        if sigma is not None:
            if "sigma" in columns:
                raise sentences.refusal("columns.sigma_twice", sigma=sigma, column=columns["sigma"])
            saved = [{s: x for s, x in table.items() if s != "sigma"} for table in saved]
            constants = {"sigma": sigma}
        columns, units = saved[0] | columns, saved[1] | units
        return dataclasses.replace(self, columns=columns, units=units, constants=constants)

    def open(self, file):
        """Return the `Table` in a file, from `open_table`."""
        name = self.text.get("delimiter")
        delimiters = DELIMITERS if name is None else (DELIMITER_NAMES[name],)
        return open_table(file, delimiters, self.text.get("decimal"))


def read_lab_format(path):
    """Return the `LabFormat` in a file, empty for None; one ParameterError lists all problems."""
    if path is None:
        return LabFormat()
    try:
        path = Path(path).expanduser()
        with path.open("rb") as file:
            contents = file.read(MAX_BYTES + 1)
    except TypeError:
        raise sentences.refusal("format.path", path=path) from None
    except (OSError, ValueError) as error:  # (ValueError: a null character in the path)
        reason = getattr(error, "strerror", None) or error
        raise sentences.refusal("format.unreadable", path=path, error=reason) from None
    if len(contents) > MAX_BYTES:
        raise sentences.refusal("format.large", name=path.name, most=MAX_BYTES)
    try:
        tables = tomllib.loads(contents.decode("utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise sentences.refusal("format.toml", name=path.name, error=error) from None
    problems = [problem for name, table in tables.items() for problem in _problems(name, table)]
    if not problems and all("sigma" in tables.get(name, ()) for name in ("columns", "constants")):
        problems.append(sentences("format.sigma_twice"))
    if problems:
        raise ParameterError("\n".join(f"{path.name}: {problem}" for problem in problems))
    return LabFormat(**tables)


def _problems(name, table):
    if name not in TABLES:
        yield sentences("format.table", table=name, wanted=one_of(TABLES, name))
    elif not isinstance(table, dict):
        yield sentences("format.no_table", table=name, key=TABLES[name][0][0])
    else:
        for key, value in table.items():
            position = {"table": name, "key": key, "value": value}
            if key not in TABLES[name][0]:
                yield sentences("format.key", wanted=one_of(TABLES[name][0], key), **position)
            elif (wanted := _expected(name, key, value)) is not None:
                yield sentences("format.value", wanted=wanted, **position)


def _expected(table, key, value):
    """Return a description of the expected value; None if the value is valid."""
    if table == "text":
        valid = [*DELIMITER_NAMES] if key == "delimiter" else [*DECIMALS]
        return None if value in valid else f"one of {', '.join(map(repr, valid))}"
    if table == "columns":
        is_valid = isinstance(value, str) or (type(value) is int and value > 0)
        return None if is_valid else "the title of a column, or its number from 1 on"
    if table == "signs":
        is_valid = type(value) is int and abs(value) == 1
        return None if is_valid else "1, as in the file, or -1, the opposite"
    if table == "units":
        is_valid = isinstance(value, str) and has_unit(key, plain_unit(value))
        return None if is_valid else f"a unit such as {EXAMPLE_UNIT[key]!r}"
    quantity = quantity_of(key, value)
    try:
        to_si(key if quantity in WHOLE_CONTACT else quantity, value)
    except ParameterError as error:
        return error.remedy.removeprefix("Give ").removesuffix(".")
    return None


@keywords_checked
def describe_lab(
    path,
    columns=None,
    units=None,
    *,
    sigma=None,
    K=None,
    M=None,
    time=None,
    displacement=None,
    lab_format=None,
):
    """Describe a laboratory's files, as text for ``read_lab(..., lab_format=...)``.

    Parameters
    ----------
    path : str, pathlib.Path or binary file
        One file of the laboratory, to be read.
    columns, units : dict, optional
        As for `read_lab`.
    sigma : float, str or pint.Quantity, optional
        Normal stress [Pa] if it was constant and not recorded.
    K : float, str or pint.Quantity, optional
        Stiffness of the machine [Pa/m], or friction per length, as in ``"3000 1/m"``.
    M : float, str or pint.Quantity, optional
        Mass of the moving parts per area of the contact [kg/m^2].
    time, displacement : pair, optional
        Window in which the file is read, as for `read_lab`.  The description does not include it.
    lab_format : str or pathlib.Path, optional
        Another description, whose values are the defaults.

    Returns
    -------
    str
        TOML with comments; tables without values are commented examples.  Write it to a file such
        as ``mylab.toml``.

    Raises
    ------
    ParameterError
        If `read_lab` would raise it, or if K or M has a wrong unit or size.

    Examples
    --------
    >>> text = describe_lab("p1234.txt", {"delta_lp": 3}, sigma="20 MPa")  # doctest: +SKIP
    >>> Path("mylab.toml").write_text(text, "utf-8")  # doctest: +SKIP
    """
    machine = {symbol: value for symbol, value in {"K": K, "M": M}.items() if value is not None}
    for symbol, value in machine.items():
        if (wanted := _expected("machine", symbol, value)) is not None:
            raise sentences.refusal("format.machine", symbol=symbol, value=value, wanted=wanted)
    lab = read_lab_format(lab_format).with_arguments(columns, units, sigma)
    table = lab.open(as_file(path))
    data, _ = build_record([table], lab, time=time, displacement=displacement)
    sources = json.loads(data.attrs["columns"])
    places = choose_columns(table, lab.columns, lab.constants)
    turned = {s: -1 for s, source in sources.items() if source.get("sign") == -1}
    if "friction" in sources.keys() - places.keys():  # a ratio of forces
        del sources["friction"]
        sources |= {
            s: {"unit": plain_unit(table.columns[places[s]].unit)} for s in ("tau", "sigma")
        }
    units = {s: source["unit"] for s, source in sources.items()}
    parts = [
        HEAD.format(source=_one_line(table.name)),
        _table("text", lab.text),
        _table("columns", {}),
        *(_column(symbol, places[symbol], table) for symbol in sources),
        _table(
            "units", {s: units[s] for s in units.keys() & lab.units}, units, "  # as in the file"
        ),
        _table("constants", {s: _as_text(s, value) for s, value in lab.constants.items()}),
        _table("signs", lab.signs | turned),
        _table("machine", lab.machine | {s: _as_text(s, value) for s, value in machine.items()}),
    ]
    return "".join(parts)


def _table(name, values, others=None, remark=""):
    """Return a TOML table of the values; `others`, or else examples, become comments."""
    _, comment, examples = TABLES[name]
    others = examples if others is None else others
    lines = {key: f"# {key} = {_toml(value)}{remark}\n" for key, value in others.items()}
    lines |= {key: f"{key} = {_toml(value)}\n" for key, value in values.items()}
    comment_mark = "# " if examples and not values else ""
    return f"\n# {comment}\n{comment_mark}[{name}]\n" + "".join(lines.values())


def _column(symbol, index, table):
    """Return a line with the title of a column, or its number if the title is not unique."""
    title = table.titles[index]
    unique = table.titles.count(title) == 1 and bool(table.columns[index].name)
    named = unique and title != f"column {index + 1}"
    comment = "" if named else f"  # {_one_line(title)}"
    return f"{symbol} = {_toml(title if named else index + 1)}{comment}\n"


def _one_line(text):
    return "".join(letter if letter.isprintable() else "?" for letter in text)


def _as_text(symbol, value):
    if isinstance(value, str):
        return value
    quantity = quantity_of(symbol, value)
    return f"{to_si(quantity, value)!r} {QUANTITIES[quantity].unit}"


def _toml(value):
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
