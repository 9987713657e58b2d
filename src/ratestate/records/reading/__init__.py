"""Records of laboratories: a file as a Dataset, and the load point's history in it.

=============================== =================================================================
``read``                        the function `read_lab`; an attempt for a page, which asks back
``record``                      from tables to a record: in which order all below is done
``joining``                     files of one experiment as one table
``lab_format``                  a laboratory's format, saved as TOML; the function `describe`
``open_table``                  which format a file has, by its first bytes; a file in memory
``text``                        a text file in blocks: encoding, delimiter, decimal comma
``header``                      names and units in the lines above the numbers
``cells``                       numbers and clock times in lines
``stored``                      which arrays of an HDF5 or MAT file are columns
``table``                       what a file holds before it is interpreted; how messages quote it
``titles``                      name and unit in a title; which names mean which quantity
``column_names.toml``           these names, units, and the usual sizes of quantities
``columns``                     which column is which quantity; which are needed
``sizes``                       units of columns, and sizes that nobody can have measured
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
