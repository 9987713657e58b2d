"""Whole runs of which the control is machine code and plain Python, compared sweep by sweep."""

import ctypes

import numpy as np
import pytest
from plain_python import Pairs

import ratestate as rs
from ratestate.engine.programs import units_of
from ratestate.engine.rows import OUTPUT
from ratestate.engine.units import lane_units


def called_from_python(law, kind):
    """Return machine code of a law's units, a lane at a time, as Python functions."""
    of_lanes = lane_units(law, kind)

    def function(name, address):
        if address == 0:
            return 0
        arguments = (ctypes.c_int64,) if name in of_lanes else (ctypes.c_void_p,) * 2
        code = ctypes.CFUNCTYPE(None, ctypes.c_void_p, *arguments)(address)

        def lanes(s, l):
            code(s.ctypes.data + 8 * l, 1)

        def point(s, l, work):
            code(s.ctypes.data + 8 * l, work.ctypes.data, work.ctypes.data + 8 * OUTPUT)

        return lanes if name in of_lanes else point

    addresses = units_of(law, kind, 1)._asdict()
    return kind(**{name: function(name, address) for name, address in addresses.items()})


LAWS = pytest.mark.parametrize("law", ["slip", "two-state-aging"])
SLIDER = {"a": 0.003, "b": 0.006, "Dc": 1e-5, "sigma": 2e6, "M": 3e3, "K": 9e8}


def slider(law, **more):
    own = {"b2": 0.001, "Dc2": 5e-5} if law.startswith("two") else {}
    return rs.SpringSlider(**SLIDER | own | more, law=law)


def loading():
    """Return jumps of speed, one to rest, and a step of normal stress."""
    return rs.Loading.steps(1e-2, (2e-3, 3e-2), (8e-3, 0.0), (9e-3, 1e-2)).sigma_step(5e-3, 2.2e6)


@LAWS
def test_a_path(law, monkeypatch):
    pairs = Pairs(monkeypatch, called_from_python)
    path = rs.simulate(slider(law), loading(), 0.015, V_start=9e-3, rtol=1e-4)
    assert int(path.steps) > 40
    assert pairs.sweeps > 40


@LAWS
def test_saved_times_of_a_batch(law, monkeypatch):
    """Two sliders, one of which vibrates (steps of the Taylor method) and returns to V = V_lp."""
    pairs = Pairs(monkeypatch, called_from_python)
    many = slider(law, M=rs.logspace("M", 1e2, 1e5, 2))
    times = np.linspace(0.0, 0.01, 8)
    run = rs.simulate(many, rs.Loading.constant(1e-1), 0.01, V_start=0.08, times=times, rtol=1e-4)
    assert int(run.cycles.max()) > 1
    assert pairs.sweeps > 40


def test_a_limit_cycle(monkeypatch):
    pairs = Pairs(monkeypatch, called_from_python, most=80)
    cycle = rs.limit_cycle(slider("slip"), 1e-2, rtol=1e-4)
    assert int(cycle.status) == 0
    assert pairs.sweeps > 40
