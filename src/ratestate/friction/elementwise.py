"""Functions of NumPy arrays made to serve floats and named DataArrays too."""

import functools
import inspect

import numpy as np


def elementwise(*dims):
    """Let a function of NumPy arrays take floats, arrays or DataArrays, as `call_elementwise`."""

    def extended(function):
        signature = inspect.signature(function)

        @functools.wraps(function)
        def of_any(*args, **kwargs):
            return call_elementwise(function, signature.bind(*args, **kwargs).arguments, *dims)

        return of_any

    return extended


def call_elementwise(function, given, *dims):
    """Call a function of NumPy arrays with floats, arrays or DataArrays by name.

    All arguments are broadcast to one shape.  The result is a DataArray if an argument is one, else
    an array, or a NumPy number for shape ().

    dims : names of the dimensions that the function adds at the end
    """

    def of_arrays(*arrays):
        full = np.broadcast_arrays(*arrays)
        return function(**dict(zip(given, full, strict=True)))

    if any(hasattr(value, "dims") for value in given.values()):
        import xarray

        return xarray.apply_ufunc(of_arrays, *given.values(), output_core_dims=[dims])
    return of_arrays(*(np.asarray(value, float) for value in given.values()))[()]
