"""All cases of a part of a sweep; one that fails, in whatever way, costs itself only."""

import math
from typing import Any, NamedTuple

import numpy as np
import xarray

from ..engine.backend import Stopped
from ..engine.model import CRASHED, FINISHED, STATUSES, STEADY_SLIDING
from ..errors import RateStateError
from ..model.arrays import cut
from ..model.quantities import attrs
from .chunks import halves

#: what cases that have an answer end with
ANSWERED = (FINISHED, STEADY_SLIDING)


class Kind(NamedTuple):
    """What a variable of the result is like: its dimensions, type, attributes and other sizes."""

    dims: tuple
    dtype: np.dtype
    attrs: dict
    own: dict  # sizes of the dimensions that are not the sweep's

    @property
    def missing(self) -> Any:
        """What stands where there is no answer: NaN where there is one, else 0 or ""."""
        if self.dtype.kind in "fc":
            return self.dtype.type(np.nan)
        return "" if self.dtype == object else self.dtype.type(0)

    def empty(self, sizes):
        """Variable without answers; sizes: those of the sweep's dimensions."""
        shape = [{**sizes, **self.own}[dim] for dim in self.dims]
        return xarray.Variable(self.dims, np.full(shape, self.missing, self.dtype), self.attrs)


def kinds_of(variables, dims):
    """Name -> `Kind` of these variables of a sweep over these dimensions."""
    return {
        name: Kind(v.dims, v.dtype, v.attrs, {d: n for d, n in v.sizes.items() if d not in dims})
        for name, v in variables.items()
    }


class Form(NamedTuple):
    """What the result of a sweep is like."""

    kinds: dict  # variable -> `Kind`
    static: dict  # variable -> it, for those that are common to all cases


def form_of(call):
    """`Form` of a call's result."""
    dims = call.batch.dims
    first = cut(call, {dim: slice(0, 1) for dim in dims})
    blank = with_messages(first.blank(), first.batch)
    static = {name: v for name, v in blank.items() if not set(v.dims) & set(dims)}
    return Form(kinds_of(blank, dims), static)


def solve(call, kinds, progress=None):
    """Variables of all cases of a call, with ``status`` and ``message`` among them.

    Parameters
    ----------
    call : a verb's checked call, see `ratestate.sweeps.calls`
    kinds : dict
        Of the variables: for cases that raise an error, which are found and get the status
        ``crashed``.
    progress : callable, optional
        Given the fraction of the cases done.
    """
    try:
        return with_messages(call.run(progress), call.batch)
    except (Stopped, RateStateError):  # of no single case
        raise
    except Exception as error:
        if call.batch.n == 1:
            return lost(call, kinds, f"{type(error).__name__}: {error}")
    dim, parts = halves(call.batch.sizes)
    return joined([solve(cut(call, places), kinds) for places in parts], dim)


def with_messages(variables, batch):
    """The same with ``status``, if the verb has none, and ``message``: why a case failed."""
    if "status" not in variables:
        done = np.full(batch.shape, FINISHED, np.int8)
        variables = variables | {"status": xarray.Variable(batch.dims, done, attrs("status"))}
    status = variables["status"].values
    message = np.full(status.shape, "", object)
    for code in np.setdiff1d(status, ANSWERED):
        message[status == code] = STATUSES[code][1]
    return variables | {"message": xarray.Variable(batch.dims, message, attrs("message"))}


def lost(call, kinds, message):
    """Variables of a call whose cases got no answer, for this reason."""
    sizes = call.batch.sizes
    variables = {name: kind.empty(sizes) for name, kind in kinds.items()}
    variables["status"][...] = CRASHED
    variables["message"][...] = f"{STATUSES[CRASHED][1]} ({message})"
    return variables


def joined(parts, dim):
    """Variables of two parts of a sweep that lie beside each other along a dimension."""
    return {
        name: xarray.Variable.concat([part[name] for part in parts], dim)
        if dim in variable.dims
        else _either(variable, parts[1][name])
        for name, variable in parts[0].items()
    }


def _either(one, other):
    """A variable that two parts have in common, from the one that has an answer."""
    if one.dtype.kind not in "fc":
        return one
    return one.copy(data=np.where(np.isnan(one.values), other.values, one.values))


def failed(variables):
    """Number of cases without an answer."""
    return int((~np.isin(variables["status"].values, ANSWERED)).sum())


def bytes_of_a_case(kinds):
    """What a case takes in memory, as a result."""
    return sum(kind.dtype.itemsize * math.prod(kind.own.values()) for kind in kinds.values())
