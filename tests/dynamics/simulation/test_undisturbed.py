"""Runs that start on unstable steady sliding, undisturbed: which they are, and what is said."""

import numpy as np
import pytest
import xarray as xr

import ratestate as rs
from ratestate.errors import RunWarning
from ratestate.sweeps import calls

V = 1e-5
SLIDER = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="500 MPa/m", M=3000)
K_C = SLIDER.K_c(V)
CONSTANT = rs.Loading.constant(V)
#: loading and other arguments of a run of 2 s in which nothing disturbs steady sliding at V
UNDISTURBED = {
    "constant": (CONSTANT, {}),
    "same V_start": (CONSTANT, {"V_start": "10 um/s"}),
    "V_start to rounding": (CONSTANT, {"V_start": V * (1 + 1e-13)}),
    "step to the same speed": (rs.Loading.steps(V, (1.0, V)), {}),
    "step at the end": (rs.Loading.steps(V, (2.0, 2 * V)), {}),
    "constant series": (rs.Loading.series([0, 1, 2], [V, V, V]), {}),
    "initial of steady sliding": (CONSTANT, {"initial": {"V": V, "theta": 1.0}}),
}
DISTURBED = {
    "step": (rs.Loading.steps(V, (2.0 - 1e-9, 2 * V)), {}),
    "hold": (CONSTANT.hold(1.0, 0.5), {}),
    "ramp": (CONSTANT.ramp(1.0, 2 * V, 0.5), {}),
    "sinusoid": (rs.Loading.sinusoid(V, 1e-7, period=1, t_end=2), {}),
    "V_start": (CONSTANT, {"V_start": V * (1 + 1e-11)}),
    "initial theta": (CONSTANT, {"initial": {"theta": 1.0 + 1e-11}}),
}


@pytest.mark.parametrize("case", UNDISTURBED)
def test_an_undisturbed_run_on_unstable_sliding_warns(case):
    loading, arguments = UNDISTURBED[case]
    with pytest.warns(RunWarning) as said:
        run = rs.simulate(SLIDER, loading, 2.0, **arguments)
    assert len(said) == 1
    assert str(said[0].message) == (
        "the run starts on steady sliding at V_lp = 10 um/s, which is unstable (K = 500 MPa/m is "
        "below K_c = 600.003 MPa/m), and nothing disturbs it, so nothing visible happens. Give "
        "another start, such as V_start = '1 um/s'."
    )
    assert pytest.approx(600.003e6, rel=1e-9) == K_C
    assert said[0].filename == __file__
    np.testing.assert_allclose(run.V, V, rtol=1e-9)


@pytest.mark.parametrize("case", DISTURBED)
def test_a_disturbed_run_does_not_warn(case):
    loading, arguments = DISTURBED[case]
    rs.simulate(SLIDER, loading, 2.0, **arguments)  # warnings are errors


@pytest.mark.parametrize("K", [K_C, K_C * (1 - 0.9e-8), np.inf])
def test_stable_sliding_has_no_warning(K):
    rs.simulate(SLIDER.replace(K=K), CONSTANT, 2.0)
    with pytest.warns(RunWarning, match=r"K_c = 600\.003 MPa/m"):
        rs.simulate(SLIDER.replace(K=K_C * (1 - 1.1e-8)), CONSTANT, 2.0)


def test_without_mass_and_by_the_remedy():
    with pytest.warns(RunWarning, match=r"below K_c = 600 MPa/m\)"):
        rs.simulate(SLIDER.replace(M=0), CONSTANT, 2.0)
    run = rs.simulate(SLIDER, CONSTANT, 30.0, V_start="1 um/s")
    assert float(run.V_max) > 100 * V


def swept(slider, store, **arguments):
    return rs.sweep("simulate", slider, progress=False, store=store, **arguments)


@pytest.mark.parametrize("way", ["simulate", "sweep", "store"])
def test_a_sweep_says_once_how_many(way, tmp_path, monkeypatch):
    monkeypatch.setattr(calls, "MAX_CASES", 2)
    slider = SLIDER.replace(K=xr.DataArray([9e8, 5.5e8, 4e8], dims="K"))
    loading = rs.Loading.constant(xr.DataArray([V, 2 * V], dims="V_lp"))
    starts = xr.DataArray([V, V], dims="V_lp")
    arguments = {"loading": loading, "t_end": 0.1, "V_start": starts}
    store = tmp_path / "x.zarr" if way == "store" else None
    with pytest.warns(RunWarning) as said:
        rs.simulate(slider, **arguments) if way == "simulate" else swept(slider, store, **arguments)
    assert len(said) == 1
    assert str(said[0].message) == (
        "in 2 of 6 cases the run starts on steady sliding that is unstable, and nothing disturbs "
        "it, so nothing visible happens. The first is at V_lp = 10 um/s, where K = 550 MPa/m is "
        "below K_c = 600.003 MPa/m. Give another start, such as V_start = '1 um/s'."
    )
    assert said[0].filename == __file__
