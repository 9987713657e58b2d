"""The origin of results: versions of programs and kind of processor, which decide last digits.

resume.py refuses a store of another origin, task.py a worker of another.

A kind of processor is that for which code is compiled: ``target`` and ``cpu``, LLVM's names for it,
the ``features`` that code may use and, for the device "cuda", ``gpu``.
"""

import json

from ..dynamics.recipe import versions
from ..engine.cuda_driver import gpu_name
from ..engine.machine_code import processor as this_processor


def origin(device):
    """{"versions": program -> version, "processor": `processor`} of this process."""
    return {"versions": json.loads(versions()), "processor": processor(device)}


def processor(device):
    """The kind of processor that this process computes on: target, cpu, features, gpu -> str."""
    target, cpu, features = this_processor()
    used = [name.removeprefix("+") for name in features.split(",") if name.startswith("+")]
    kind = {"target": target, "cpu": cpu, "features": " ".join(used)}
    if device == "cpu":
        return kind
    return kind | {"gpu": gpu_name()}


def processor_name(processor):
    """Short name of a kind of processor; None: it was not recorded."""
    if processor is None:
        return "not recorded"
    return "; ".join(filter(None, (processor["cpu"], processor.get("gpu"))))


def origin_differences(old, now):
    """Differences of two origins that may change last digits, as a list of lines; [] if none.

    Another version of ratestate alone does not count: its kernels have a digest of their own.  Nor
    does an old processor that was not recorded.
    """
    there, here = old["versions"], now["versions"]
    changed = [name for name in sorted({*there, *here}) if there.get(name) != here.get(name)]
    lines = [
        f"version of {name}: {there.get(name)} made the store, {here.get(name)} is here"
        for name in changed
        if changed != ["ratestate"]
    ]
    stored, own = old.get("processor"), now["processor"]
    if stored not in (None, own):
        pair = f"{processor_name(stored)} made the store, {processor_name(own)} is here"
        lines.append(f"processor: {pair}{_feature_differences(stored, own)}")
    return lines


def _feature_differences(stored, own):
    """The features that only one of two kinds of processor has, in parentheses."""
    there, here = ({*processor["features"].split()} for processor in (stored, own))
    sides = {"there": sorted(there - here), "here": sorted(here - there)}
    only = [f"only {where}: {', '.join(names)}" for where, names in sides.items() if names]
    return f" ({'; '.join(only)})" if only else ""
