"""What a sweep was asked: recorded in its store, and compared before it goes on."""

import dataclasses
import hashlib
import json

import numpy as np
import xarray

from ..model.quantities import QUANTITIES
from ..model.units import is_array


def inputs_of(verb, call):
    """Dataset of all arguments of a call: arrays and numbers as variables, the rest attributes."""
    variables, texts = {}, {"verb": verb}
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
            texts[f"coordinate {name}"] = _in_words(value)
    return xarray.Dataset(variables, attrs=texts)


def _variable(name, dims, values):
    """A variable with dimensions of its own: those of the sweep may have names of parameters."""
    return xarray.Variable([f"{name}, {dim}" for dim in dims], values)


def _in_words(labels):
    """Labels as text: the first few, and what tells all from others."""
    texts = labels.values.astype(str).ravel().tolist()
    digest = hashlib.sha256(json.dumps(texts).encode()).hexdigest()[:16]
    more = ", ..." if len(texts) > 5 else ""
    return f"{', '.join(texts[:5])}{more} ({len(texts)} labels, SHA-256 {digest})"


def _leaves(value, name=""):
    """(name, value) of all that a call holds, down to the last dataclass."""
    if dataclasses.is_dataclass(value):
        value = {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
    if not isinstance(value, dict):
        yield name, value
        return
    for key, part in value.items():
        # the slider's parameters are known by their symbols
        inside = f"{name} {key}" if name and name != "slider" else key
        yield from _leaves(part, inside.removesuffix("_initial"))


def checksum(inputs):
    """SHA-256 of all values, as text."""
    digest = hashlib.sha256(json.dumps(inputs.attrs, sort_keys=True).encode())
    for name in sorted(inputs.variables):
        variable = inputs.variables[name]
        digest.update(f"{name} {variable.dims} {variable.shape}".encode())
        digest.update(np.ascontiguousarray(variable.values, float).tobytes())
    return digest.hexdigest()


def differences(stored, asked):
    """What two sets of inputs differ in, a line each."""
    lines = []
    for name in sorted({*stored.attrs, *asked.attrs}):
        there, here = stored.attrs.get(name, "not given"), asked.attrs.get(name, "not given")
        if there != here:
            lines.append(f"{name}: {there} in the store, {here} now")
    found = {}
    for name in sorted({*stored.variables, *asked.variables}):
        there, here = stored.variables.get(name), asked.variables.get(name)
        if there is None or here is None or not there.equals(here):
            found[name] = f"{name}: {_differ(name, there, here)}"
    # (the coordinate of an axis differs whenever the axis does)
    return lines + [line for name, line in found.items() if _symbol(name) not in found]


def _symbol(name):
    """The symbol whose values a coordinate repeats, or nothing."""
    return name.removeprefix("coordinate ") if name.startswith("coordinate ") else None


def _differ(name, there, here):
    """How two variables differ."""
    if there is None or here is None or there.dims != here.dims or there.shape != here.shape:
        return f"{_shown(name, there)} in the store, {_shown(name, here)} now"
    old, new = there.values, here.values
    other = np.argwhere(~((old == new) | (np.isnan(old) & np.isnan(new))))
    first = tuple(other[0])
    unit = _unit(name)
    pair = f"{old[first].item()!r}{unit} in the store, {new[first].item()!r}{unit} now"
    if not there.dims:
        return pair
    dims = [dim.removeprefix(f"{name}, ") for dim in there.dims]
    place = ", ".join(f"{dim}[{i}]" for dim, i in zip(dims, first, strict=True))
    return f"{len(other)} of {old.size} values differ, first at {place}: {pair}"


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
