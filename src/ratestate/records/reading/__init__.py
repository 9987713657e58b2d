"""Read a laboratory's files as a Dataset that includes the history of the load point.

`open_table` makes a table of columns from a file, `columns` chooses among them by `titles`, and
`assembly` builds the record: `rows` are selected, `values` checked, and `sizes` converted to SI.
"""

from .read import read_lab

__all__ = ["read_lab"]
