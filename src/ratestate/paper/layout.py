"""What figures of the paper have in common: titles, and where a stick-slip cycle slips."""

import numpy as np

from ..plot.labels import LAWS


def titled(data, title, law=None):
    """The Dataset of a figure with its title and source added to the provenance it carries."""
    text = f"{title}; {LAWS[law] if law else 'both evolution laws'}"
    source = "Im, Marone & Elsworth (2019), doi:10.1016/j.jmps.2018.08.026"
    return data.assign_attrs(title=text, references=source)


def steepest(run):
    """The run with time counted from where, in its middle half, tau falls fastest."""
    first, last = (float(run.time[i]) for i in (0, -1))
    margin = (last - first) / 4
    rate = run.tau.differentiate("time").sel(time=slice(first + margin, last - margin))
    return run.assign_coords(time=run.time - rate.time[int(np.argmin(rate.values))])
