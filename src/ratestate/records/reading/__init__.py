"""Records of laboratories: a file as a Dataset, and the load point's history in it."""

from .read import read_lab
from .segments import find_segments

__all__ = ["find_segments", "read_lab"]
