"""Read a laboratory's files as a Dataset that includes the history of the load point.

`open_table` makes a table of columns from a file, `columns` chooses among them by `titles`, and
`assembly` builds the record: `rows` are selected, `values` checked, and `sizes` converted to SI.
"""

from ..load_point.segments import find_segments
from .lab_format import describe
from .read import Attempt, read_lab, try_reading
from .titles import EXAMPLE_UNIT

__all__ = ["EXAMPLE_UNIT", "Attempt", "describe", "find_segments", "read_lab", "try_reading"]
