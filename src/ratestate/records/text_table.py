"""A table of texts as lines, to print."""


def lines_of(table):
    """Lines (list of str) of a pandas DataFrame of texts: headings where their columns begin."""
    columns = [["", *map(str, table.index)], *([name, *table[name]] for name in table.columns)]
    widths = [max(map(len, column)) for column in columns]
    rows = zip(*columns, strict=True)
    return ["   ".join(map(str.ljust, row, widths)).rstrip() for row in rows]
