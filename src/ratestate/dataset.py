"""What results carry beside their numbers: status flags and provenance."""

import json
from importlib.metadata import version

import numpy as np

from .engine.model import STATUSES
from .units import is_array


def status_variable(batch, status):
    """The status of each case, int8 with CF flags."""
    variable = batch.variable(np.asarray(status, np.int8), "status")
    variable.attrs["flag_values"] = np.array(list(STATUSES), np.int8)
    variable.attrs["flag_meanings"] = " ".join(name for name, _ in STATUSES.values())
    return variable


def provenance(verb, slider, **settings):
    """Attributes with which a result can be made again: the call, its values, the versions."""
    parameters = {symbol: plain(value) for symbol, value in slider.parameters.items()}
    return {
        "title": f"ratestate {verb}",
        "slider": json.dumps(parameters),
        **{k: v for k, v in settings.items() if v is not None},
        "versions": json.dumps({name: version(name) for name in ("ratestate", "numba", "numpy")}),
    }


def plain(value):
    """A value as JSON holds it; a DataArray by dimensions and values."""
    if not is_array(value):
        return value
    return {"dims": list(value.dims), "values": value.values.tolist()}


def loading_record(loading):
    """The loading as JSON text: segments' starts, speeds and accelerations, and its end."""
    V, rate = (plain(v) if is_array(v) else v.tolist() for v in (loading.V, loading.rate))
    last = loading.t_last if np.isfinite(loading.t_last) else None
    return json.dumps({"t": loading.t.tolist(), "V": V, "rate": rate, "t_last": last})
