"""The functions that can be swept, and their checked calls, which can be divided into parts.

A call is a frozen dataclass of arguments in SI.  ``batch`` broadcasts them, ``run()`` returns the
variables of all cases, ``blank()`` returns them without answers, ``dataset(variables)`` returns the
result.  `arrays.isel` selects a part of it.
"""

import inspect
import re
from collections.abc import Callable, Hashable

from ..dynamics.cycles.limit_cycle import limit_cycle, limit_cycle_call
from ..dynamics.simulation.settings import undisturbed_warning
from ..dynamics.simulation.simulate import simulate, simulate_call
from ..dynamics.steady_sliding import (
    frequency_response,
    frequency_response_call,
    stability,
    stability_call,
)
from ..engine.backend import check_device_name
from ..errors import ParameterError
from ..model.arrays import isel
from ..model.initial_state import initial_state
from ..model.names import check_keywords
from . import sentence
from .chunks import chunks_of

#: name -> the function, and the one that checks its arguments and returns a call
FUNCTIONS: dict[str, tuple[Callable, Callable]] = {
    "limit_cycle": (limit_cycle, limit_cycle_call),
    "simulate": (simulate, simulate_call),
    "stability": (stability, stability_call),
    "frequency_response": (frequency_response, frequency_response_call),
}
IN_CLOSED_FORM = ("stability", "frequency_response")
#: names of variables and groups that a sweep's result needs itself
RESERVED = ("message", "status", "sweep")
# Cases whose starts are checked at a time: some 30 MB.
MAX_CASES = 100_000


def call_of(function, slider, arguments):
    """Return the name of a function that can be swept, given as such or by name, and its call.

    ParameterError for another function, arguments that it refuses, nothing to sweep over, and names
    or labels of coordinates that a result or store cannot have.
    """
    known: dict[Hashable, str] = {name: name for name in FUNCTIONS}
    known |= {function: name for name, (function, _) in FUNCTIONS.items()}
    name = known.get(function) if isinstance(function, Hashable) else None
    if name is None:
        raise ParameterError(
            sentence("call.unknown", function=function, names=", ".join(FUNCTIONS))
        )
    function, checked_call = FUNCTIONS[name]
    signature = inspect.signature(function)
    check_keywords(f"sweep of {name}", arguments, signature.parameters)
    try:
        bound = signature.bind(slider, **arguments)
    except TypeError as error:
        raise ParameterError(f"sweep of {name}: {error}. See help(ratestate.{name}).") from None
    bound.apply_defaults()
    call = checked_call(*bound.args, **bound.kwargs)
    if call.batch.is_single:
        raise ParameterError(sentence("call.nothing", name=name))
    _check_names(call)
    if call.batch.n == 0:
        sizes = dict(call.batch.sizes)
        raise ParameterError(f"no cases: dimensions {sizes}. Give each at least one value.")
    return name, call


def _check_names(call):
    """Raise ParameterError for dimensions and coordinates that a result or store cannot have."""
    coords = call.dataset({}).coords
    for name in {*call.batch.dims, *coords}:
        if name in RESERVED or not re.fullmatch(r"[^\s/.][^\s/]*", str(name)):
            raise ParameterError(sentence("call.name", name=name, reserved=", ".join(RESERVED)))
    for name, labels in coords.items():
        plain = labels.dtype.kind != "O" or all(isinstance(x, str) for x in labels.values.flat)
        if not plain or (name in coords.indexes and coords.indexes[name].nlevels > 1):
            raise ParameterError(sentence("call.labels", name=name))


def check_cases(call, chunks):
    """Raise ParameterError if initial values of any case contradict each other."""
    if getattr(call, "initial", None):
        for i in range(chunks.number):
            part = isel(call, chunks.slices(i))
            table, rows = part.batch.rows(part.loading.V)
            initial_state(part.slider.friction_law, part.batch, table[rows, 0])


def undisturbed(name, call):
    """What a `RunWarning` says of cases of a checked call that stay on unstable sliding, or ""."""
    if name != "simulate":
        return ""
    chunks = chunks_of(call.batch.sizes, MAX_CASES)
    return undisturbed_warning(isel(call, chunks.slices(i)) for i in range(chunks.number))


def check_device(name, call, device):
    """Raise ParameterError unless this device can run the call; that it is there is not checked."""
    check_device_name(device)
    if device == "cuda" and name in IN_CLOSED_FORM:
        raise ParameterError(f"device = 'cuda': {name} needs no GPU. Leave device out.")
