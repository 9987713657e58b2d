"""Variables of results, and their tables as text."""

from ...model.conversion import in_si
from ...model.quantities import attrs
from ..messages import kit as sentences

#: attributes of a record that results keep
RECORD_ATTRIBUTES = ("source", "columns", "found", "notes")


def kept_attributes(record):
    """What a result keeps of its record's attributes."""
    return {name: record.attrs[name] for name in RECORD_ATTRIBUTES if name in record.attrs}


def checked_result(result, function, name):
    """A result in SI; ParameterError if it is not of this function or lacks a variable NAME."""
    title = getattr(result, "attrs", {}).get("title")
    if title != f"ratestate {function}" or name not in result:
        raise sentences.refusal("result.other", function=function)
    return in_si(result)


def labelled(dims, **values):
    """name -> variable along these dimensions (or one); each name is one of `QUANTITIES`."""
    return {name: (dims, value, attrs(name)) for name, value in values.items()}


def with_errors(dims, measured):
    """As `labelled`, of name -> (values, standard errors): variables NAME and NAME_error."""
    columns: dict = {}
    for name, (values, errors) in measured.items():
        columns |= {name: values, f"{name}_error": errors}
    return labelled(dims, **columns)


def lines_of(table):
    """Lines (list of str) of a pandas DataFrame of texts: headings where their columns begin."""
    columns = [["", *map(str, table.index)], *([name, *table[name]] for name in table.columns)]
    widths = [max(map(len, column)) for column in columns]
    rows = zip(*columns, strict=True)
    return ["   ".join(map(str.ljust, row, widths)).rstrip() for row in rows]
