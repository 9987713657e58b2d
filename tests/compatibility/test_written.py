"""Files that were written before the package had its present layout."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray
from matplotlib.figure import Figure
from written import RESULTS, SLIDER, STEPS, V_LP, swept

import ratestate as rs
from ratestate import files, scenario
from ratestate.dynamics.recipe import recorded_loading
from ratestate.interfaces.cli import main

HERE = Path(__file__).parent
BEFORE = HERE / "written"


def same_numbers(now, before):
    """That numbers are those of before, but for what another processor may round differently."""
    assert set(before.variables) <= set(now.variables)
    for name, variable in before.variables.items():
        values = now[name].values
        if variable.dtype.kind not in "fc":
            np.testing.assert_array_equal(values, variable.values, err_msg=name)
        elif not name.endswith(("error", "residual", "nonlinearity")):
            scale = np.nanmax(np.abs(variable.values), initial=0.0)
            where = {"rtol": 1e-7, "atol": 1e-9 * scale, "err_msg": name}
            np.testing.assert_allclose(values, variable.values, **where)


@pytest.mark.parametrize("name", RESULTS)
def test_results_of_an_earlier_version_are_read(name, tmp_path):
    """Values and provenance are read; the scenario is refused."""
    path = BEFORE / f"{name}.nc"
    if name == "runs":
        path = tmp_path / "runs.zarr"
        shutil.unpack_archive(BEFORE / "runs.zip", path)
    before, again = files.read(path), RESULTS[name]()
    same_numbers(again, before)
    for symbol in ("a", "K", "M", "law"):
        xarray.testing.assert_equal(
            *(xarray.Dataset({"x": rs.plot.parameter(one, symbol)}) for one in (before, again))
        )
    assert isinstance(rs.plot.figure(before), Figure)
    with pytest.raises(rs.ParameterError, match="does not record the scenario that made it"):
        scenario.from_result(before)


def test_parameters_of_selected_cases_are_read_from_old_results():
    cycles = files.read(BEFORE / "limit_cycle.nc")
    for whole in (cycles, RESULTS["limit_cycle"]()):
        assert rs.plot.parameter(whole.isel(V_lp=1), "V_lp") == V_LP.values[1]
        assert rs.plot.parameter(whole.isel(V_lp=[0, 2]), "V_lp").values.tolist() == [3.3e-3, 1e-2]


def test_labels_are_not_values():
    """A coordinate of the name of a parameter may label a dimension only."""
    K = xarray.DataArray([6e8, 9e8], {"K": [1, 2]}, dims="K")
    result = rs.stability(SLIDER.replace(K=K), 1e-3)
    recorded = SLIDER.parameters | {"K": {"dims": ["K"], "values": [6e8, 9e8]}}
    result.attrs = {"title": "ratestate stability", "slider": json.dumps(recorded)}
    assert rs.plot.parameter(result, "K").values.tolist() == [6e8, 9e8]
    with pytest.raises(rs.ParameterError, match="has lost the values of 'K'"):
        rs.plot.parameter(result.isel(K=0), "K")


def test_the_load_point_of_a_run():
    loading = recorded_loading(files.read(BEFORE / "calls.nc"))
    assert [call.method for call in loading.calls] == ["constant", "step", "hold"]
    assert (loading.t.tolist(), loading.V.tolist()) == (STEPS.t.tolist(), STEPS.V.tolist())


@pytest.fixture
def store(tmp_path):
    shutil.unpack_archive(BEFORE / "store.zip", tmp_path / "store.zarr")
    return tmp_path / "store.zarr"


def test_a_store_of_an_earlier_version_is_read_but_not_resumed(store, capsys):
    """It is read, with values and provenance, and not resumed."""
    main(["sweep", "--store", str(store), "--status", "--verify"], standalone_mode=False)
    said = capsys.readouterr().out
    assert "all files are intact" in said
    assert "versions  ratestate 0.1.0, " in said
    before = files.read(store)
    assert before.status.values.tolist() == [[1, 0, 0], [1, 0, 0], [0, 0, 0], [0, 0, 0]]
    xarray.testing.assert_identical(before, xarray.open_zarr(store).load())
    assert "slider" in before.attrs
    same_numbers(swept(None), before)
    with pytest.raises(rs.StoreError, match="written by an earlier version"):
        swept(store)
