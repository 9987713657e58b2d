"""A step of the load point, by us and by the textbook."""

import functools

import numpy as np
from textbook import Textbook

import ratestate as rs


def load_step(law, p, V):
    """To V from a third of it: `simulate` with all but tolerance and times, the times, the twin, y.

    p : parameters of the slider [SI], with its form of friction, if it has one; y : by the twin
    """
    twin, times = Textbook(law, p), np.linspace(0.0, 6.0 * p["Dc"] / V, 7)
    slider, loading = rs.SpringSlider(**p, law=law), rs.Loading.constant(V)
    run = functools.partial(rs.simulate, slider, loading, times[-1], V_start=V / 3.0)
    return run, times, twin, twin.solve(twin.steady(V / 3.0), V, times)
