"""Files that were written before the package had its present layout."""

import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray
from written import RESULTS, swept

import ratestate as rs
from ratestate import files
from ratestate.interfaces import scenario
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
def test_results(name):
    before, again = files.read(BEFORE / f"{name}.nc"), RESULTS[name]()
    same_numbers(again, before)
    if name == "simulate":  # it records its loading as results did before
        with pytest.raises(rs.ParameterError, match="from an earlier version of ratestate"):
            scenario.from_result(before)
    else:
        xarray.testing.assert_identical(scenario.run(scenario.from_result(before)), again)


@pytest.fixture
def store(tmp_path):
    shutil.unpack_archive(BEFORE / "store.zip", tmp_path / "store.zarr")
    return tmp_path / "store.zarr"


def test_store(store, capsys):
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
