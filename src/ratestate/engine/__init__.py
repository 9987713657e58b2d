"""Compiled code only: no xarray, no units, no files but those of compiled kernels."""
