"""Records of laboratories: a file as a Dataset, and the load point's history in it.

=============================== =================================================================
``read``                        the function `read_lab`; an attempt for a page, which asks back
``record``                      from tables to a record: in which order all below is done, and how
                                files of one experiment are joined
``lab_format``                  a laboratory's format, saved as TOML; the function `describe`
``open_table``                  which format a file has, by its first bytes; a file in memory;
                                which arrays of an HDF5 or MAT file are columns
``text``                        a text file in blocks: encoding, delimiter, decimal comma
``header``                      names and units in the lines above the numbers
``cells``                       numbers and clock times in lines
``titles``                      name and unit in a title; which names mean which quantity
``column_names.toml``           these names, units, and the usual sizes of quantities
``columns``                     what a file holds, and how messages quote it; which column is which
                                quantity; their units
``sizes``                       sizes that nobody can have measured, or few
``rows``                        which rows are kept: windows, cells without number, times, gaps;
                                means over blocks of rows, of a very long record
``values``                      rows with codes, impossible values or dropouts; signs to turn;
                                columns that contradict each other, or are too coarse
=============================== =================================================================
"""

from ..load_point.segments import find_segments
from .lab_format import describe
from .read import read_lab

__all__ = ["describe", "find_segments", "read_lab"]
