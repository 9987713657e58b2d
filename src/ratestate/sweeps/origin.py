"""What decides the bits beside a sweep's inputs: versions of programs, kind of processor."""

import json

from numba.core.registry import cpu_target

from ..dynamics.results import versions


def origin(device):
    """Versions and `processor` that this process would solve chunks with."""
    return {"versions": json.loads(versions()), "processor": processor(device)}


def processor(device):
    """Kind of processor that kernels are compiled for here, as numba tells LLVM.

    Returns
    -------
    dict of str
        ``target`` and ``cpu``, LLVM's names for them, and ``features`` that code may use; for the
        device "cuda" also ``gpu``.
    """
    target, cpu, features = cpu_target.target_context.codegen().magic_tuple()
    used = [name.removeprefix("+") for name in features.split(",") if name.startswith("+")]
    found = {"target": target, "cpu": cpu, "features": " ".join(used)}
    return found if device == "cpu" else found | {"gpu": _gpu()}


def _gpu():
    """Name and compute capability of the GPU that numba uses."""
    from numba import cuda

    device = cuda.get_current_device()
    name = device.name.decode() if isinstance(device.name, bytes) else device.name
    return f"{name}, compute capability {'.'.join(map(str, device.compute_capability))}"


def named(kind):
    """A kind of processor in a few words; None: of which nothing is known."""
    if kind is None:
        return "not recorded"
    return "; ".join(filter(None, (kind["cpu"], kind.get("gpu"))))


def differences(made, kind, here):
    """In what an origin differs from the one here so that bits may, a line each.

    Another version of ratestate alone is no difference: its kernels have a digest of their own.

    made : versions
    kind : of processor; None: not recorded, and no difference
    here : `origin`
    """
    new = here["versions"]
    changed = [name for name in sorted({*made, *new}) if made.get(name) != new.get(name)]
    lines = [
        f"version of {name}: {made.get(name)} made the store, {new.get(name)} is here"
        for name in changed
        if changed != ["ratestate"]
    ]
    if kind not in (None, here["processor"]):
        lines.append(f"processor: {_two(kind, here['processor'])}")
    return lines


def _two(stored, here):
    there, now = ({*kind["features"].split()} for kind in (stored, here))
    sides = {"there": sorted(there - now), "here": sorted(now - there)}
    only = [f"only {where}: {', '.join(names)}" for where, names in sides.items() if names]
    more = f" ({'; '.join(only)})" if only else ""
    return f"{named(stored)} made the store, {named(here)} is here{more}"
