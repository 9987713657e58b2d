"""Forms of friction other than eq. 1: their formulas, and the laws that take them."""

import pickle

import numpy as np
import xarray as xr

import ratestate as rs
from ratestate import files, scenario
from ratestate.dynamics.results import law_of_result, parameter
from ratestate.friction.composition import composed_law

CUT = rs.SpringSlider(
    a=0.003, b=0.006, Dc=1e-5, sigma=2e6, M=3e3, K=4e8, friction_form="cut-off", V1=1e-2, V2=1.0
)


def test_the_slider_keeps_its_form(tmp_path):
    assert CUT.friction_law.name == "slip+cut-off"
    assert CUT.friction_law is composed_law("slip+cut-off")
    damped = CUT.replace(damping=1e4)
    assert damped.friction_law is composed_law("slip+cut-off+damping")
    assert rs.SpringSlider(**damped.parameters) == damped
    assert pickle.loads(pickle.dumps(damped)) == damped
    assert "friction_form='cut-off', V1='10 mm/s', V2='1 m/s'" in repr(CUT)
    assert "cut-off" in CUT._repr_html_()
    assert CUT.replace(friction_form="LOG").values.keys() == {*"a b Dc sigma K M mu0 V0".split()}
    swept = CUT.replace(V1=xr.DataArray([1e-3, 1e-2], dims="V1"))
    cycles = rs.sweep(rs.limit_cycle, swept, V_lp=1e-4, store=tmp_path / "x.zarr", chunk=1)
    assert float(cycles.amplitude[1]) == float(rs.limit_cycle(CUT, 1e-4).amplitude)
    run = rs.simulate(CUT, rs.Loading.constant(1e-3), 0.05, V_start=5e-4)
    text = scenario.toml(scenario.from_result(run))
    assert 'friction_form = "cut-off"' in text
    assert scenario.loads(text).slider == CUT
    lines: dict = {}
    exec(scenario.python(scenario.loads(text)), lines)
    np.testing.assert_array_equal(lines["result"].tau, run.tau)
    again = files.read(files.write(run, tmp_path / "run.nc"))
    assert parameter(again, "friction_form") == "cut-off"
    assert law_of_result(again) is CUT.friction_law
    assert parameter(rs.stability(CUT.replace(friction_form="log"), 1.0), "friction_form") == "log"


def test_mu_w_may_equal_mu0():
    plain = {"a": 0.003, "b": 0.006, "Dc": 1e-5, "sigma": 2e6, "K": 1e9}
    assert rs.SpringSlider(**plain, law="flash-heating", V_w=0.1, mu_w=0.6).mu_w == 0.6
