"""Read a laboratory's files as a Dataset that includes the history of the load point.

=============================== =================================================================
``read``                        the functions `read_lab` and `try_reading`
``assembly``                    builds the record from tables, in the order of all steps below;
                                joins the files of one experiment
``lab_format``                  a laboratory's format, saved as TOML; the function `describe`
``open_table``                  detects the format of a file; files in memory; arrays of HDF5 and
                                MAT files that are columns
``text``                        reads text files in blocks: encoding, delimiter, decimal mark
``header``                      names and units in the lines above the numbers
``cells``                       numbers and clock times in lines
``titles``                      splits a title into name and unit; matches names to quantities
``column_names.toml``           these names, the units, and typical sizes of quantities
``columns``                     columns and tables; which column is which quantity; units
``sizes``                       impossible and unusual sizes
``rows``                        selects rows: windows, cells without numbers, times, gaps; block
                                means of very long records
``values``                      rows with codes, impossible values or dropouts; signs to turn;
                                columns that contradict each other or are too coarse
=============================== =================================================================
"""

from ..load_point.segments import find_segments
from .lab_format import describe
from .read import Attempt, read_lab, try_reading
from .titles import EXAMPLE_UNIT

__all__ = ["EXAMPLE_UNIT", "Attempt", "describe", "find_segments", "read_lab", "try_reading"]
