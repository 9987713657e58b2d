"""Variables of results, and their tables as text."""

from ...model.quantities import attrs

#: attributes of a record that results keep
RECORD_ATTRIBUTES = ("source", "columns", "found", "notes")


def kept_attributes(record):
    """What a result keeps of its record's attributes."""
    return {name: record.attrs[name] for name in RECORD_ATTRIBUTES if name in record.attrs}


def labelled(dims, **values):
    """name -> variable along these dimensions (or one); each name is one of `QUANTITIES`."""
    return {name: (dims, value, attrs(name)) for name, value in values.items()}


def lines_of(table):
    """Lines (list of str) of a pandas DataFrame of texts: headings where their columns begin."""
    columns = [["", *map(str, table.index)], *([name, *table[name]] for name in table.columns)]
    widths = [max(map(len, column)) for column in columns]
    rows = zip(*columns, strict=True)
    return ["   ".join(map(str.ljust, row, widths)).rstrip() for row in rows]
