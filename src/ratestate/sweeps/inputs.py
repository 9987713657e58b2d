"""The inputs of a sweep: recorded in its store, and compared before it is resumed."""

import dataclasses
import hashlib
import json

import numpy as np
import xarray

from ..model.quantities import QUANTITIES
from ..model.units import is_array


def inputs_of(name, call):
    """Dataset of all arguments of a call: arrays and numbers as variables, the rest as attributes.

    name : of the function
    """
    variables, texts = {}, {"verb": name}
    for name, value in _leaves(call):
        if is_array(value):
            variables[name] = _variable(name, value.dims, value.values)
        elif isinstance(value, np.ndarray):
            variables[name] = _variable(name, range(value.ndim), value)
        elif isinstance(value, float | int):
            variables[name] = xarray.Variable((), float(value))
        elif value is not None:
            texts[name] = value
    coordinates = call.dataset({}).coords
    for name, value in coordinates.items():
        if value.dtype.kind in "biuf":
            label = f"coordinate {name}"
            variables[label] = _variable(label, value.dims, value.values)
        else:  # texts, dates
            texts[f"coordinate {name}"] = _label_summary(value)
    return xarray.Dataset(variables, attrs=texts)


def _variable(name, dims, values):
    """A variable with its own dimensions, since those of the sweep may be named like variables."""
    return xarray.Variable([f"{name}, {dim}" for dim in dims], values)


def _label_summary(labels):
    """Labels as a string: the first few, and a digest of all."""
    texts = labels.values.astype(str).ravel().tolist()
    digest = hashlib.sha256(json.dumps(texts).encode()).hexdigest()[:16]
    more = ", ..." if len(texts) > 5 else ""
    return f"{', '.join(texts[:5])}{more} ({len(texts)} labels, SHA-256 {digest})"


def _leaves(value, name=""):
    """Yield (name, value) for all fields of a call, those of nested dataclasses included."""
    if dataclasses.is_dataclass(value):
        value = {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
    if not isinstance(value, dict):
        yield name, value
        return
    for key, part in value.items():
        # the slider's parameters have no prefix
        inside = f"{name} {key}" if name and name != "slider" else key
        yield from _leaves(part, inside.removesuffix("_initial"))


def checksum(inputs):
    """SHA-256 of all inputs, hexadecimal."""
    digest = hashlib.sha256(json.dumps(inputs.attrs, sort_keys=True).encode())
    for name in sorted(inputs.variables):
        variable = inputs.variables[name]
        digest.update(f"{name} {variable.dims} {variable.shape}".encode())
        digest.update(np.ascontiguousarray(variable.values, float).tobytes())
    return digest.hexdigest()


def input_differences(stored, requested):
    """Differences between two sets of inputs, as lines."""
    lines = []
    for name in sorted({*stored.attrs, *requested.attrs}):
        old, new = stored.attrs.get(name, "not given"), requested.attrs.get(name, "not given")
        if old != new:
            lines.append(f"{name}: {old} in the store, {new} now")
    changed = {}
    for name in sorted({*stored.variables, *requested.variables}):
        old, new = stored.variables.get(name), requested.variables.get(name)
        if old is None or new is None or not old.equals(new):
            changed[name] = f"{name}: {_difference(name, old, new)}"
    # (the coordinate of an axis differs whenever the axis does)
    repeated = {f"coordinate {name}" for name in changed}
    return lines + [line for name, line in changed.items() if name not in repeated]


def _difference(name, stored, requested):
    """How two variables differ, of which one may be None."""
    if (
        stored is None
        or requested is None
        or stored.shape != requested.shape
        or stored.dims != requested.dims
    ):
        return f"{_shown(name, stored)} in the store, {_shown(name, requested)} now"
    old, new = stored.values, requested.values
    differing = np.argwhere(~((old == new) | (np.isnan(old) & np.isnan(new))))
    first = tuple(differing[0])
    unit = _unit(name)
    pair = f"{old[first].item()!r}{unit} in the store, {new[first].item()!r}{unit} now"
    if not stored.dims:
        return pair
    dims = [dim.removeprefix(f"{name}, ") for dim in stored.dims]
    index = ", ".join(f"{dim}[{i}]" for dim, i in zip(dims, first, strict=True))
    return f"{len(differing)} of {old.size} values differ, first at {index}: {pair}"


def _shown(name, variable):
    if variable is None:
        return "not given"
    if not variable.dims:
        return f"{variable.values.item()!r}{_unit(name)}"
    sizes = ", ".join(
        f"{dim.removeprefix(f'{name}, ')}: {size}" for dim, size in variable.sizes.items()
    )
    low, high = np.min(variable.values), np.max(variable.values)
    return f"<{sizes}; {low:.6g} to {high:.6g}{_unit(name)}>"


def _unit(name):
    unit = QUANTITIES[name].unit if name in QUANTITIES else "1"
    return "" if unit == "1" else f" {unit}"
