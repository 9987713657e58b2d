"""Solve all cases of a part of a sweep; a case that fails does not affect the others."""

import math
from typing import Any, NamedTuple

import numpy as np
import xarray

from ..engine.backend import Stopped
from ..engine.model import CRASHED, FINISHED, STATUSES, STEADY_SLIDING
from ..errors import RateStateError
from ..model.arrays import isel
from ..model.quantities import attrs

#: statuses of cases that have an answer
ANSWERED = (FINISHED, STEADY_SLIDING)


class VariableSpec(NamedTuple):
    """Dimensions, type and attributes of a variable of the result."""

    dims: tuple
    dtype: np.dtype
    attrs: dict
    sizes: dict  # sizes of the dimensions that are not the sweep's

    @property
    def missing(self) -> Any:
        """The value of a case without an answer: NaN, -1 for flags that have it, 0, False or ""."""
        if self.dtype.kind in "fc":
            return self.dtype.type(np.nan)
        if -1 in self.attrs.get("flag_values", ()):
            return self.dtype.type(-1)
        return "" if self.dtype == object else self.dtype.type(0)

    def empty(self, sizes):
        """Return a Variable without answers; sizes: dimension of the sweep -> number of values."""
        shape = [{**sizes, **self.sizes}[dim] for dim in self.dims]
        return xarray.Variable(self.dims, np.full(shape, self.missing, self.dtype), self.attrs)


class Form(NamedTuple):
    """The variables of a sweep's result, before it is computed."""

    specs: dict  # name -> `VariableSpec`
    static: dict  # name -> variable, for those common to all cases, such as saved times

    @property
    def swept(self):
        """The specifications of variables that differ between cases."""
        return {name: spec for name, spec in self.specs.items() if name not in self.static}


def form_of(call):
    """Return the `Form` of a call's result."""
    dims = call.batch.dims
    first = isel(call, {dim: slice(0, 1) for dim in dims})
    specs, static = {}, {}
    for name, v in with_messages(first.blank(), first.batch).items():
        sizes = {dim: n for dim, n in v.sizes.items() if dim not in dims}
        specs[name] = VariableSpec(v.dims, v.dtype, v.attrs, sizes)
        if len(sizes) == v.ndim:
            static[name] = v
    return Form(specs, static)


def solve(call, specs, progress=None):
    """Return variables of all cases of a call, ``status`` and ``message`` among them.

    A case that raises an error is found by halving, and gets the status ``crashed``.  Only
    `RateStateError`, which concerns them all, and `Stopped` are raised.

    specs : variable -> `VariableSpec`
    progress : called with the fraction of the cases done, or None
    """
    try:
        return with_messages(call.run(progress), call.batch)
    except (Stopped, RateStateError):  # not due to a single case
        raise
    except Exception as error:
        if call.batch.n == 1:
            variables = {name: spec.empty(call.batch.sizes) for name, spec in specs.items()}
            why = f"{STATUSES[CRASHED][1]} ({type(error).__name__}: {error})"
            variables["status"][...], variables["message"][...] = CRASHED, why
            return variables
    dim, parts = halves(call.batch.sizes)
    return concatenate([solve(isel(call, slices), specs) for slices in parts], dim)


def with_messages(variables, batch):
    """Return variables with ``status``, FINISHED if they have none, and ``message``.

    A message says why a case failed, or is "".
    """
    if "status" not in variables:
        done = np.full(batch.shape, FINISHED, np.int8)
        variables = variables | {"status": xarray.Variable(batch.dims, done, attrs("status"))}
    status = variables["status"].values
    message = np.full(status.shape, "", object)
    for code in np.setdiff1d(status, ANSWERED):
        message[status == code] = STATUSES[code][1]
    return variables | {"message": xarray.Variable(batch.dims, message, attrs("message"))}


def concatenate(parts, dim):
    """Return the variables of a list of two parts of a sweep, adjacent along dim."""
    joined = {}
    for name, variable in parts[0].items():
        other = parts[1][name]
        if dim in variable.dims:
            joined[name] = xarray.Variable.concat([variable, other], dim)
        elif variable.dtype.kind in "fc":  # common to both: from the part that has an answer
            values = variable.values
            joined[name] = variable.copy(data=np.where(np.isnan(values), other.values, values))
        else:
            joined[name] = variable
    return joined


def halves(sizes):
    """Return the longest dimension of a block, and its halves: a list of {dimension: slice}."""
    dim = max(sizes, key=sizes.__getitem__)
    middle = sizes[dim] // 2
    return dim, [{dim: slice(0, middle)}, {dim: slice(middle, sizes[dim])}]


def count_failed(variables):
    """Return the number of cases that are neither finished nor steady sliding, by ``status``."""
    return int((~np.isin(variables["status"].values, ANSWERED)).sum())


def bytes_per_case(specs):
    """Return the bytes of memory that the result of a case takes; 8 for each text."""
    return sum(spec.dtype.itemsize * math.prod(spec.sizes.values()) for spec in specs.values())
