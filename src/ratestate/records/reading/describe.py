"""A laboratory's format as TOML, out of one file of it that can be read."""

import json

from ...model.names import keywords_checked
from .columns import choose_columns
from .lab_format import LabFormat, as_text, checked_machine, lab_format, toml_text
from .open_table import file_of, open_table
from .record import record_of
from .titles import plain

#: what each table of the file means
HEAD = """\
# How the files of a laboratory are read, found in {source}:
#     ratestate fit FILE --format THIS_FILE
#     ratestate.read_lab(file, format="THIS_FILE")
# What is given in a call goes before what is written here.
"""
TEXT = """
# Only where it is not found in the file: what stands between cells ("tab", ",", ";" or "space"),
# and the decimal mark ("." or ",").
# [text]
# delimiter = ";"
# decimal = ","
"""
COLUMNS = """
# The title of each column that is read, or its number from 1 on.
[columns]
"""
UNITS = """
# Units of columns that have none in the file, or another there.
[units]
"""
CONSTANTS = """
# Normal stress where it is not recorded.
{off}[constants]
{off}sigma = {sigma}
"""
SIGNS = """
# -1: the sign in the file is turned; 1: it is right.  Of columns that are not here it is turned if
# stress or friction is negative throughout, or if the load point runs downwards.
{off}[signs]
"""
MACHINE = """
# Stiffness (per area of the contact, or friction per length) and mass (per area) of the machine.
{off}[machine]
{off_K}K = {K}
{off_M}M = {M}
"""


@keywords_checked
def describe(
    path,
    columns=None,
    units=None,
    *,
    sigma=None,
    K=None,
    M=None,
    time=None,
    displacement=None,
    format=None,  # noqa: A002 (as of read_lab)
):
    """A description of a laboratory's files, as text for ``read_lab(..., format=...)``.

    Parameters
    ----------
    path : str, pathlib.Path or binary file
        One file of the laboratory, which is read.
    columns, units : dict, optional
        As of `read_lab`.
    sigma : float, str or pint.Quantity, optional
        Normal stress [Pa] where it was constant and not recorded.
    K : float, str or pint.Quantity, optional
        Stiffness of the machine [Pa/m], or friction per length, as in ``"3000 1/m"``.
    M : float, str or pint.Quantity, optional
        Mass per area of what it moves [kg/m^2].
    time, displacement : pair, optional
        Window in which the file is read, as of `read_lab`; the description does not have it.
    format : str or pathlib.Path, optional
        Another description, which this one begins with.

    Returns
    -------
    str
        TOML, with comments: write it to a file such as ``mylab.toml``.

    Raises
    ------
    ParameterError
        As of `read_lab`; and a stiffness or a mass of another kind.

    Examples
    --------
    >>> text = describe("p1234.txt", {"delta_lp": 3}, sigma="20 MPa")  # doctest: +SKIP
    >>> Path("mylab.toml").write_text(text, "utf-8")  # doctest: +SKIP
    """
    machine = checked_machine({"K": K, "M": M})
    own = LabFormat() if format is None else lab_format(format)
    file = file_of(path)
    table = open_table(file, own.delimiters, own.decimal)
    windows = {"time": time, "displacement": displacement}
    data, _ = record_of([table], [file.name], columns, units, **windows, sigma=sigma, lab=own)
    sources = json.loads(data.attrs["columns"])
    constant = own.constants.get("sigma") if sigma is None else sigma
    given = own.merged_columns(columns, constant)
    places = choose_columns(table, given, () if constant is None else ("sigma",))
    signs = {s: -1 for s, source in sources.items() if source.get("sign") == -1}
    units = own.merged_units(units, constant)
    if "friction" in sources.keys() - places.keys():  # a ratio of forces
        del sources["friction"]
        sources |= {s: {"unit": plain(table.columns[places[s]].unit)} for s in ("tau", "sigma")}
    parts = [
        HEAD.format(source=_comment(file.name)),
        _text_table(own),
        COLUMNS,
        *(_column(symbol, places[symbol], table) for symbol in sources),
        UNITS,
        *(_unit(symbol, source["unit"], units) for symbol, source in sources.items()),
        _constants_table(constant),
        _signs_table(own.signs | signs),
        _machine_table(own.machine | machine),
    ]
    return "".join(parts)


def _comment(name):
    """The name of a file on one line."""
    return "".join(letter if letter.isprintable() else "?" for letter in name)


def _text_table(own):
    """What the format that was given says of text; nothing by default."""
    text = own.text_table()
    if not text:
        return TEXT
    return "\n[text]\n" + "".join(f"{key} = {toml_text(value)}\n" for key, value in text.items())


def _column(symbol, index, table):
    """A line with the title of a column, its number where that is no name of it alone."""
    title = table.titles[index]
    unique = table.titles.count(title) == 1 and bool(table.columns[index].name)
    named = unique and title != f"column {index + 1}"
    comment = "" if named else f"  # {_comment(title)}"
    return f"{symbol} = {toml_text(title) if named else index + 1}{comment}\n"


def _unit(symbol, unit, given):
    """A line with the unit of a column; a comment if it is that in the file."""
    off, beside = ("", "") if symbol in given else ("# ", "  # as in the file")
    return f"{off}{symbol} = {toml_text(unit)}{beside}\n"


def _constants_table(sigma):
    """The table of constants, a comment if there are none."""
    off = "# " if sigma is None else ""
    stress = "20 MPa" if sigma is None else as_text("sigma", sigma)
    return CONSTANTS.format(off=off, sigma=toml_text(stress))


def _signs_table(signs):
    """The table of signs, a comment if none is known."""
    lines = [f"{symbol} = {sign}\n" for symbol, sign in signs.items()] or ["# delta_lp = -1\n"]
    return SIGNS.format(off="" if signs else "# ") + "".join(lines)


def _machine_table(machine):
    """The table of the machine, each line a comment if it is not known."""
    off = {symbol: "" if symbol in machine else "# " for symbol in ("K", "M")}
    values = {"K": "1 GPa/m", "M": "3000 kg/m^2"} | machine
    texts = {symbol: toml_text(value) for symbol, value in values.items()}
    none = "" if machine else "# "
    return MACHINE.format(off=none, off_K=off["K"], off_M=off["M"], **texts)
