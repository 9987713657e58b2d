"""Regimes: named as the paper names them, from numbers that a result carries through a file."""

import json

import numpy as np
import pytest
import xarray as xr

import ratestate as rs
from ratestate import ParameterError, SpringSlider, limit_cycle, logspace
from ratestate.dynamics.cycles.regimes import REGIMES, classify
from ratestate.dynamics.results import parameter
from ratestate.paper.parameters import FIG2, FIG4, FIG4_K, FIG6, FIG6_SPEEDS

LAWS = pytest.mark.parametrize("law", ["slip", "aging"])


def through_a_file(result, path):
    result.to_netcdf(path, engine="h5netcdf")
    with xr.open_dataset(path, engine="h5netcdf") as back:
        return back.load()


def rebuilt(result):
    symbols = SpringSlider(a=1, b=1, Dc=1, sigma=1, K=1).parameters
    return SpringSlider(**{symbol: parameter(result, symbol) for symbol in symbols})


@LAWS
def test_fig4_as_the_paper_names_it(law):
    """Sticks and slips up to the least amplitude, at 3 to 5 cm/s, and is harmonic beyond."""
    V_lp = xr.DataArray([1e-4, 1e-3, 1e-2, 0.1, 0.3, 1.0], dims="V_lp")
    K = xr.DataArray(FIG4_K, dims="K")
    found = classify(limit_cycle(FIG4.replace(law=law, K=K), V_lp, rtol=1e-6))
    assert found.regime.dims == ("K", "V_lp")
    for row in found.regime.values:
        assert row.tolist() == 3 * ["stick-slip"] + 3 * ["quasi-harmonic"]
    assert found.agree.all()
    eta = 100.0 * V_lp.values**2 / (4e6 * 0.005 * 1e-5)
    np.testing.assert_allclose(found.eta, np.tile(eta, (2, 1)), rtol=1e-12)


@LAWS
def test_fig6_is_steady_and_then_slow_stick_slip(law):
    V_lp = xr.DataArray(list(FIG6_SPEEDS), dims="V_lp")
    found = classify(limit_cycle(FIG6.replace(law=law), V_lp, rtol=1e-6))
    assert found.regime.values.tolist() == ["steady", "slow stick-slip"]
    assert found.regime_by_eta.values.tolist() == ["steady", "stick-slip"]
    assert found.agree.all()
    assert float(found.inertia[1]) < found.attrs["slow_inertia"] == 0.1
    # a spring half as stiff: the same speed, and inertia in every slip
    soft = classify(limit_cycle(FIG6.replace(law=law, K=0.5 * FIG6.K), FIG6_SPEEDS[1], rtol=1e-6))
    assert soft.regime == "stick-slip"


def test_disagreement_is_reported():
    found = classify(limit_cycle(FIG2, "3.2 mm/s", rtol=1e-6))
    assert found.regime == "quasi-harmonic"
    assert found.regime_by_eta == "stick-slip"
    assert not found.agree
    assert float(found.eta) == pytest.approx(0.512, rel=1e-12)
    assert float(found.fundamental) > found.attrs["harmonic_share"] == 0.87


def test_failed_cases_are_unknown(tmp_path):
    K = xr.DataArray([5e8, 5e9], dims="K")
    cycle = limit_cycle(FIG4.replace(M=0.0, K=K), 1e-5, rtol=1e-6)
    found = through_a_file(classify(cycle), tmp_path / "regimes.nc")
    assert found.regime.values.tolist() == ["unknown", "steady"]
    assert found.regime_by_eta.values.tolist() == ["unknown", "steady"]
    assert found.agree.values.tolist() == [False, True]
    assert set(found.regime.values) < set(REGIMES)


def test_variables_are_labelled_and_the_input_is_kept():
    cycle = limit_cycle(FIG4, 1e-3, rtol=1e-6)
    found = classify(cycle)
    assert list(found.data_vars) == [
        *("inertia", "fundamental", "slow_fraction", "V_max"),
        *("regime", "regime_by_eta", "agree", "eta"),
    ]
    for name, variable in found.data_vars.items():
        assert {"units", "long_name"} <= set(variable.attrs), name
        assert variable.shape == ()
    for name in ("inertia", "fundamental", "slow_fraction", "V_max"):
        assert found[name].equals(cycle[name])
    assert cycle.attrs["title"] == "ratestate limit_cycle"


def test_along_a_branch():
    branch = rs.continue_cycle(FIG4.replace(law="aging"), "V_lp", 1e-3, 1.0, rtol=1e-6)
    found = classify(branch)
    assert found.regime.dims == ("point",)
    np.testing.assert_allclose(found.eta, 500.0 * branch.V_lp**2, rtol=1e-12)
    assert found.regime.values[[0, -1]].tolist() == ["stick-slip", "quasi-harmonic"]
    by_K = rs.continue_cycle(FIG4, "K", 0.9e9, 1.1e9, V_lp=1e-2, rtol=1e-6)
    np.testing.assert_allclose(classify(by_K).eta, 0.05, rtol=1e-12)
    by_M = rs.continue_cycle(FIG4, "M", 100.0, 200.0, V_lp=1e-2, rtol=1e-6)
    np.testing.assert_allclose(classify(by_M).eta, 5e-4 * by_M.M, rtol=1e-12)


def test_a_dimension_called_eta_and_lost_attributes_are_refused():
    M = xr.DataArray([100.0, 200.0], dims="eta")
    cycle = limit_cycle(FIG4.replace(M=M), 1e-2, rtol=1e-6)
    with pytest.raises(ParameterError, match="Rename"):
        classify(cycle)
    assert classify(cycle.rename(eta="case")).eta.dims == ("case",)
    with pytest.raises(ParameterError, match="lost its attribute"):
        classify(limit_cycle(FIG4, 1e-2, rtol=1e-6).drop_attrs())


def test_sliders_are_rebuilt_from_files(tmp_path):
    sweep = FIG2.replace(M=logspace("M", 1e2, 1e4, 3), law="aging")
    V_lp = logspace("V_lp", 1e-3, 1e-1, 4)
    back = through_a_file(limit_cycle(sweep, V_lp, rtol=1e-6), tmp_path / "cycles.nc")
    assert rebuilt(back) == sweep
    assert parameter(back, "V_lp").equals(V_lp)
    assert np.iscomplexobj(back.multipliers)
    assert parameter(back.sel(M=1e3), "M") == 1e3
    one = through_a_file(limit_cycle(FIG2, 3.2e-3, rtol=1e-6), tmp_path / "cycle.nc")
    assert rebuilt(one) == FIG2
    assert parameter(one, "V_lp") == 3.2e-3


def test_large_arrays_are_rebuilt_from_coordinates(tmp_path):
    shape = xr.DataArray(np.geomspace(1.0, 2.0, 1010).reshape(2, 505), dims=("one", "two"))
    sweep = FIG2.replace(K=6e9 * shape)
    back = through_a_file(limit_cycle(sweep, 1e-6, rtol=1e-6), tmp_path / "cycles.nc")
    assert json.loads(back.attrs["scenario"])["slider"]["K"] == {"variable": "K"}
    assert rebuilt(back).K.dims == ("one", "two")
    np.testing.assert_array_equal(rebuilt(back).K, 6e9 * shape)


def test_labels_are_not_values():
    K = xr.DataArray([6e8, 9e8], {"K": [1, 2]}, dims="K")
    found = limit_cycle(FIG2.replace(K=K), 1e-4, rtol=1e-6)
    np.testing.assert_array_equal(parameter(found, "K"), [6e8, 9e8])
