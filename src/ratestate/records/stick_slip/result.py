"""The Dataset of a catalogue of events."""

import numpy as np
import xarray

from ...dynamics.results import flags, versions
from ...model.quantities import attrs
from .measures import STATUSES
from .stiffness import stiffness_text
from .trends import Trend

#: most samples of the record that a catalogue carries, for its figure
MOST = 20000


def dataset(data, series, catalogue):
    """The Dataset that `events` returns."""
    variables: dict = {}
    for name, (value, error) in catalogue.values.items():
        variables[name] = ("event", value, attrs(name))
        variables[f"{name}_error"] = ("event", error, attrs(f"{name}_error"))
    kind, samples, status, message = catalogue.columns
    variables["event_kind"] = ("event", kind, attrs("event_kind"))
    variables["samples_in_fall"] = ("event", samples, attrs("samples_in_fall"))
    flagged = attrs("event_status") | flags(STATUSES)
    variables["event_status"] = ("event", status.astype(np.int8), flagged)
    variables["event_message"] = ("event", message, attrs("event_message"))
    for name in Trend._fields:
        label = f"trend_{name}"
        column = np.array([getattr(line, name) for line in catalogue.trends.values()])
        variables[label] = ("abscissa", column, attrs(label))
    stiffness, noise = catalogue.stiffness, catalogue.noise
    numbers = {"K": stiffness.K, "K_error": stiffness.error, "tau_noise": noise.sd}
    numbers["tau_noise_correlation"] = noise.correlation
    numbers["detection_threshold"] = catalogue.threshold
    variables |= {name: ((), value, attrs(name)) for name, value in numbers.items()}
    time, tau = _thinned(series.t, series.tau)
    variables["tau"] = ("time", tau, attrs("tau"))
    coords = {
        "event": ("event", np.arange(1, status.size + 1), attrs("event")),
        "abscissa": ("abscissa", [*catalogue.trends], {"long_name": "abscissa of the line"}),
        "time": ("time", time, attrs("time")),
    }
    return xarray.Dataset(variables, coords, _attributes(data, series, stiffness))


def _attributes(data, series, stiffness):
    """Title, source of the record, slider of the run, mass, where K is from, versions."""
    kept = {name: data.attrs[name] for name in ("source", "slider") if name in data.attrs}
    mass = {} if series.M is None else {"M": series.M}
    return {
        "title": "ratestate events",
        **kept,
        **mass,
        "stiffness": stiffness_text(stiffness),
        "versions": versions(),
    }


def _thinned(t, tau):
    """A record with the largest and smallest of so many samples in turn, if it has more."""
    if t.size <= MOST:
        return t, tau
    every = -(-2 * t.size // MOST)
    rows = t.size // every * every
    blocks = tau[:rows].reshape(-1, every)
    first = np.arange(blocks.shape[0]) * every
    pairs = np.sort(np.stack([first + blocks.argmin(1), first + blocks.argmax(1)], 1), axis=1)
    at = np.unique(np.append(pairs.ravel(), [0, t.size - 1]))
    return t[at], tau[at]
