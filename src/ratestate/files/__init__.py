"""Results as files: NetCDF, CSV or Zarr by the ending of the name, whole or not there at all."""

from .formats import NUMBERS, read, write
from .netcdf import joined, split
from .place import PICTURES, checked_path, replace, writing
from .table import csv_text

__all__ = [
    "NUMBERS",
    "PICTURES",
    "checked_path",
    "csv_text",
    "joined",
    "read",
    "replace",
    "split",
    "write",
    "writing",
]
