"""Regimes: named as the paper names them, from numbers that a result carries through a file."""

import numpy as np
import pytest
import xarray as xr

from ratestate import ParameterError, files, limit_cycle
from ratestate.dynamics.cycles.regimes import REGIMES, classify
from ratestate.dynamics.results import parameter
from ratestate.paper.parameters import FIG2, FIG4, FIG4_K, FIG6, FIG6_SPEEDS

LAWS = pytest.mark.parametrize("law", ["slip", "aging"])


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
    found = files.read(files.write(classify(cycle), tmp_path / "regimes.nc"))
    assert found.regime.values.tolist() == ["unknown", "steady"]
    assert found.regime_by_eta.values.tolist() == ["unknown", "steady"]
    assert found.agree.values.tolist() == [False, True]
    assert set(found.regime.values) < set(REGIMES)


def test_a_dimension_called_eta_and_lost_attributes_are_refused():
    M = xr.DataArray([100.0, 200.0], dims="eta")
    cycle = limit_cycle(FIG4.replace(M=M), 1e-2, rtol=1e-6)
    with pytest.raises(ParameterError, match="Rename"):
        classify(cycle)
    assert classify(cycle.rename(eta="case")).eta.dims == ("case",)
    with pytest.raises(ParameterError, match="lost its attribute"):
        classify(limit_cycle(FIG4, 1e-2, rtol=1e-6).drop_attrs())


def test_labels_are_not_values():
    K = xr.DataArray([6e8, 9e8], {"K": [1, 2]}, dims="K")
    found = limit_cycle(FIG2.replace(K=K), 1e-4, rtol=1e-6)
    np.testing.assert_array_equal(parameter(found, "K"), [6e8, 9e8])
