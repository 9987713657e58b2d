"""The origin of results: versions of programs and kind of processor, which decide last digits."""

import json

from numba.core.registry import cpu_target

from ..dynamics.results import versions


def origin(device):
    """Versions and `processor` with which this process solves chunks."""
    return {"versions": json.loads(versions()), "processor": processor(device)}


def processor(device):
    """Kind of processor for which numba compiles kernels in this process.

    Returns
    -------
    dict of str
        ``target`` and ``cpu``, LLVM's names for them, and ``features`` that code may use; for the
        device "cuda" also ``gpu``.
    """
    target, cpu, features = cpu_target.target_context.codegen().magic_tuple()
    used = [name.removeprefix("+") for name in features.split(",") if name.startswith("+")]
    kind = {"target": target, "cpu": cpu, "features": " ".join(used)}
    return kind if device == "cpu" else kind | {"gpu": _gpu()}


def _gpu():
    """Name and compute capability of the GPU that numba uses."""
    from numba import cuda

    device = cuda.get_current_device()
    name = device.name.decode() if isinstance(device.name, bytes) else device.name
    return f"{name}, compute capability {'.'.join(map(str, device.compute_capability))}"


def processor_name(processor):
    """Short name of a kind of processor; None: it was not recorded."""
    if processor is None:
        return "not recorded"
    return "; ".join(filter(None, (processor["cpu"], processor.get("gpu"))))


def origin_differences(old_versions, processor, now):
    """Differences of a recorded origin from the present one that may change last digits, as lines.

    Another version of ratestate alone does not count: its kernels have a digest of their own.

    old_versions : dict of the recorded versions
    processor : the recorded kind; None: not recorded, which does not count as a difference
    now : the present `origin`
    """
    new = now["versions"]
    changed = [
        name for name in sorted({*old_versions, *new}) if old_versions.get(name) != new.get(name)
    ]
    lines = [
        f"version of {name}: {old_versions.get(name)} made the store, {new.get(name)} is here"
        for name in changed
        if changed != ["ratestate"]
    ]
    if processor not in (None, now["processor"]):
        lines.append(f"processor: {_processor_difference(processor, now['processor'])}")
    return lines


def _processor_difference(stored, now):
    """How two kinds of processor differ."""
    there, here = ({*processor["features"].split()} for processor in (stored, now))
    sides = {"there": sorted(there - here), "here": sorted(here - there)}
    only = [f"only {where}: {', '.join(names)}" for where, names in sides.items() if names]
    more = f" ({'; '.join(only)})" if only else ""
    return f"{processor_name(stored)} made the store, {processor_name(now)} is here{more}"
