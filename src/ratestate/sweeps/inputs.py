"""The inputs of a sweep: recorded in its store, and compared before it is resumed."""

import dataclasses
import hashlib
import json

import numpy as np
import xarray

from ..model.quantities import QUANTITIES
from ..model.units import is_array


def inputs_of(name, call):
    """Arguments [SI] of a call of function `name`, as Dataset: numbers as variables.

    All else are attributes, and what is None is left out.
    """
    variables, texts = {}, {"verb": name}
    for name, value in _leaves(call):
        if is_array(value):
            variables[name] = _variable(name, value.dims, value.values)
        elif isinstance(value, np.ndarray | float | int):
            variables[name] = _variable(name, range(np.ndim(value)), np.asarray(value, float))
        elif value is not None:
            texts[name] = value
    for dim, value in call.dataset({}).coords.items():
        name = f"coordinate {dim}"
        if value.dtype.kind in "biuf":
            variables[name] = _variable(name, value.dims, value.values)
        else:  # texts, dates
            texts[name] = _label_summary(value)
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
        own = {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
        value = getattr(value, "parameters", own)  # of a slider or a loading
    if not isinstance(value, dict):
        yield name, value
        return
    for key, part in value.items():
        # the slider's parameters have no prefix
        inside = f"{name} {key}" if name and name != "slider" else key
        yield from _leaves(part, inside.removesuffix("_initial"))


def checksum(inputs):
    """SHA-256 of all inputs, a Dataset from `inputs_of`; hexadecimal text."""
    digest = hashlib.sha256(json.dumps(inputs.attrs, sort_keys=True).encode())
    for name in sorted(inputs.variables):
        variable = inputs.variables[name]
        digest.update(f"{name} {variable.dims} {variable.shape}".encode())
        digest.update(np.ascontiguousarray(variable.values, float).tobytes())
    return digest.hexdigest()


def input_differences(stored, requested):
    """Differences between two Datasets from `inputs_of`, as a list of lines; [] if they agree."""
    lines = []
    for name in sorted({*stored.attrs, *requested.attrs}):
        old, new = stored.attrs.get(name, "not given"), requested.attrs.get(name, "not given")
        if old != new:
            lines.append(f"{name}: {old} in the store, {new} now")
    changed = {}
    for name in sorted({*stored.variables, *requested.variables}):
        old, new = stored.variables.get(name), requested.variables.get(name)
        if old is None or not old.equals(new):
            changed[name] = f"{name}: {_difference(name, old, new)}"
    # (the coordinate of an axis differs whenever the axis does)
    repeated = {f"coordinate {name}" for name in changed}
    return lines + [line for name, line in changed.items() if name not in repeated]


def _difference(name, stored, requested):
    """How two variables differ, of which one may be None."""
    sizes = [list(one.sizes.items()) for one in (stored, requested) if one is not None]
    if len(sizes) < 2 or sizes[0] != sizes[1]:
        return f"{_summary(name, stored)} in the store, {_summary(name, requested)} now"
    old, new = stored.values, requested.values
    differing = np.argwhere((old != new) & ~(np.isnan(old) & np.isnan(new)))
    first = tuple(differing[0])
    pair = f"{_number(name, old[first])} in the store, {_number(name, new[first])} now"
    if not first:
        return pair
    dims = [dim.removeprefix(f"{name}, ") for dim in stored.dims]
    index = ", ".join(f"{dim}[{i}]" for dim, i in zip(dims, first, strict=True))
    return f"{len(differing)} of {old.size} values differ, first at {index}: {pair}"


def _summary(name, variable):
    """A variable, or None, in short."""
    if variable is None:
        return "not given"
    if not variable.dims:
        return _number(name, variable.values)
    sizes = [f"{dim.removeprefix(f'{name}, ')}: {n}" for dim, n in variable.sizes.items()]
    low, high = np.min(variable.values), np.max(variable.values)
    return f"<{', '.join(sizes)}; {low:.6g} to {high:.6g}{_unit(name)}>"


def _number(name, value):
    return f"{value.item()!r}{_unit(name)}"


def _unit(name):
    unit = QUANTITIES[name].unit if name in QUANTITIES else "1"
    return "" if unit == "1" else f" {unit}"
