"""The functions that can be swept, and their checked calls, which can be divided into parts.

A call is a frozen dataclass of arguments in SI.  ``batch`` broadcasts them, ``run()`` returns the
variables of all cases, ``blank()`` returns them without answers, ``dataset(variables)`` returns the
result.  `arrays.isel` selects a part of it.  A store records its arguments, and what decides the
last digits of its results, as texts, which are compared before the store is resumed.
"""

import dataclasses
import hashlib
import inspect
import json
import re
from collections.abc import Callable, Hashable

import numpy as np

from ..dynamics.cycles.limit_cycle import limit_cycle, limit_cycle_call
from ..dynamics.recipe import versions
from ..dynamics.simulation.settings import undisturbed_warning
from ..dynamics.simulation.simulate import simulate, simulate_call
from ..dynamics.steady_sliding import (
    frequency_response,
    frequency_response_call,
    stability,
    stability_call,
)
from ..engine.cuda_driver import gpu_name
from ..engine.machine_code import processor as this_processor
from ..errors import ParameterError
from ..model.arrays import isel
from ..model.initial_state import initial_state
from ..model.names import check_keywords
from ..model.quantities import QUANTITIES
from ..model.units import is_array
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
DEVICES = ("cpu", "cuda")
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
        for slices in chunks:
            part = isel(call, slices)
            table, rows = part.batch.rows(part.loading.V)
            initial_state(part.slider.friction_law, part.batch, table[rows, 0])


def undisturbed(name, call):
    """What a `RunWarning` says of cases of a checked call that stay on unstable sliding, or ""."""
    if name != "simulate":
        return ""
    return undisturbed_warning(isel(call, part) for part in chunks_of(call.batch.sizes, MAX_CASES))


def check_device(name, call, device):
    """Raise ParameterError unless this device can run the call; that it is there is not checked."""
    if not isinstance(device, str) or device not in DEVICES:
        raise ParameterError(f"device = {device!r} is unknown. Choose one of {', '.join(DEVICES)}.")
    if device == "cuda" and name in IN_CLOSED_FORM:
        raise ParameterError(f"device = 'cuda': {name} needs no GPU. Leave device out.")


def arguments_of(name, call):
    """Return the arguments [SI] of a call of function `name`, and coordinates: name -> text.

    Texts of different values differ.  Arguments that are None are left out.
    """
    texts = {"function": name}
    for name, value in _leaves(call):
        unit = QUANTITIES[name].unit if name in QUANTITIES else "1"
        unit = "" if unit == "1" else f" {unit}"
        if is_array(value):
            texts[name] = _summary(value.values, value.sizes, unit)
        elif isinstance(value, np.ndarray) and value.ndim:
            texts[name] = _summary(value, {}, unit)
        elif isinstance(value, np.ndarray | float | int):
            texts[name] = f"{float(value)!r}{unit}"
        elif value is not None:
            texts[name] = str(value)
    coords = call.dataset({}).coords.items()
    return texts | {f"coordinate {dim}": _summary(x.values, x.sizes) for dim, x in coords}


def _summary(values, sizes, unit=""):
    """Return an array in short, with a digest: two that differ in the last bit have other texts."""
    if values.dtype.kind in "biuf":
        found = f"{values.min():.6g} to {values.max():.6g}{unit}"
        content = np.ascontiguousarray(values).tobytes()
    else:  # texts, dates
        texts = values.astype(str).ravel().tolist()
        found = ", ".join(texts[:5]) + (", ..." if len(texts) > 5 else "")
        content = json.dumps(texts).encode()
    dims_text = ", ".join(f"{dim}: {n}" for dim, n in sizes.items()) or f"{values.size} values"
    return f"<{dims_text}; {found}; SHA-256 {hashlib.sha256(content).hexdigest()[:16]}>"


def _leaves(value, name=""):
    """Yield (name, value) for all fields of a call and of nested dataclasses."""
    if dataclasses.is_dataclass(value):
        fields = {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
        value = getattr(value, "parameters", fields)  # of a slider or a loading
    if not isinstance(value, dict):
        yield name, value
        return
    for key, part in value.items():
        # the slider's parameters have no prefix
        inside = f"{name} {key}" if name and name != "slider" else key
        yield from _leaves(part, inside.removesuffix("_initial"))


def origin(device):
    """Return what decides the last digits of this process's results: versions and processor.

    Each is a dict of texts.  A kind of processor is that for which code is compiled: LLVM's names
    of target and processor, the features that code may use, and the GPU.
    """
    target, cpu, features = this_processor()
    used = {f"feature {text[1:]}": "used" for text in features.split(",") if text[:1] == "+"}
    gpu = {} if device == "cpu" else {"gpu": gpu_name()}
    return {
        "versions": json.loads(versions()),
        "processor": {"target": target, "cpu": cpu, **gpu, **used},
    }


def origin_differences(stored, current):
    """Return the differences of two origins that may change last digits, as a list of lines.

    Another version of ratestate alone does not count: its kernels have a digest of their own.
    """
    lines = differences(stored["versions"], current["versions"], "version of ")
    if len(lines) == 1 and lines[0].startswith("version of ratestate:"):
        lines = []
    return lines + differences(stored["processor"], current["processor"], "processor, ")


def differences(stored, current, label=""):
    """Return the differences between two dicts of texts, as a list of lines."""
    changed = {name for name in {*stored, *current} if stored.get(name) != current.get(name)}
    # (the coordinate of an axis differs whenever the axis does)
    changed -= {f"coordinate {name}" for name in changed}
    return [
        f"{label}{name}: {stored.get(name, 'none')} in the store, {current.get(name, 'none')} now"
        for name in sorted(changed)
    ]
