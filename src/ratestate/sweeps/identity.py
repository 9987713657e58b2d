"""Texts that identify a sweep in its store, and their differences.

A store records the arguments of the sweep, and what decides the last digits of its results.  They
are compared before the store is resumed.
"""

import dataclasses
import hashlib
import json

import numpy as np

from ..dynamics.recipe import versions
from ..engine.cuda_driver import gpu_name
from ..engine.machine_code import processor as this_processor
from ..model.quantities import QUANTITIES
from ..model.units import is_array


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
