"""Results as files: NetCDF, CSV or Zarr by the ending of the name, whole or not there at all.

================== =================================================================
``formats``        `read` and `write`: which ending is which format
``netcdf``         NetCDF; complex variables as two real ones, `split` and `joined`
``table``          which variables a CSV has, in which rows and columns
``laboratory_csv`` tables of events, steps or holds in a laboratory's units
``zarr_folder``    Zarr, with the checksums of its files; whether all are as written
``place``          whether a file can be put there; replaced at once
================== =================================================================
"""

from .formats import NUMBERS, read, write
from .laboratory_csv import laboratory_csv
from .netcdf import joined, split
from .place import PICTURES, checked_path, replace, writing
from .table import csv_text

__all__ = [
    "NUMBERS",
    "PICTURES",
    "checked_path",
    "csv_text",
    "joined",
    "laboratory_csv",
    "read",
    "replace",
    "split",
    "write",
    "writing",
]
