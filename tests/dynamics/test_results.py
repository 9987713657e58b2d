"""Every function of a slider: what its result says, a file of it, and batches under three laws."""

import json
from functools import partial

import numpy as np
import pytest
import xarray as xr
from textbook import OF_LAW

import ratestate as rs
from ratestate import files
from ratestate.dynamics.basin import escape
from ratestate.dynamics.results import parameter

COMMON = {"a": 0.003, "b": 0.006, "Dc": 1e-5, "sigma": 2e6, "M": 3e3, "K": 9e8}
LAWS = "aging", "two-state-slip", "nagata"


def run(slider, V_lp, **settings):
    """Return a run with a step to a load point at V_lp."""
    times = {} if settings else {"times": [0.0, 0.02, 0.05]}
    loading = rs.Loading.steps(1e-4, (0.01, V_lp))
    return rs.simulate(slider, loading, **{"t_end": 0.05} | times | settings)


FUNCTIONS = {
    "stability": rs.stability,
    "hopf": rs.hopf,
    "stabilize": rs.stabilize,
    "frequency_response": lambda slider, V_lp: rs.frequency_response(slider, V_lp, [3.0, 30.0]),
    "simulate": run,
    "limit_cycle": partial(rs.limit_cycle, rtol=1e-6),
    "escape": escape,
}
EVERY = pytest.mark.parametrize("function", FUNCTIONS)


def slider(law, **changes):
    return rs.SpringSlider(**COMMON | OF_LAW[law] | changes, law=law)


@EVERY
def test_a_result_says_what_it_is_and_comes_back_from_a_file(function, tmp_path):
    law, given = "aging", slider("aging")
    found = FUNCTIONS[function](given, "1 mm/s")
    for name, variable in found.variables.items():
        assert variable.attrs["long_name"], name
        assert "units" in variable.attrs or variable.dtype.kind == "U", name
    assert function == "simulate" or float(found.V_lp) == 1e-3
    if function == "hopf":
        assert (found.title, found.law, found.parameter) == ("ratestate hopf", law, "K")
        assert rs.SpringSlider(**json.loads(found.slider)) == given
        return
    for name in ("K", "law", "V_lp")[: 2 + (function != "simulate")]:
        assert parameter(found, name) == {"K": 9e8, "law": law, "V_lp": 1e-3}[name]
    again = files.read(files.write(found, tmp_path / "result.nc")).load()
    xr.testing.assert_identical(again, found)
    status = found.get("status")
    if status is not None:
        assert status.dtype == np.int8
        assert len(status.flag_meanings.split()) == len(set(status.flag_values.tolist()))
    scenario = json.loads(found.attrs["scenario"])
    assert scenario.pop("function") == function
    assert rs.SpringSlider(**scenario.pop("slider")) == given


@pytest.mark.parametrize("law", LAWS)
@EVERY
def test_each_case_of_a_batch_is_as_by_itself(function, law):
    """With arrays of the slider, the speed and, of a run, its end and times."""
    M = xr.DataArray([1e2, 3e3, 1e5], dims="M")
    V_lp = xr.DataArray([1e-3, 2e-3], dims="V_lp")
    settings, own = {}, {}
    if function == "frequency_response":  # of stable sliding
        own["K"] = 1e10
    if function == "simulate":
        settings["t_end"] = xr.DataArray([0.04, 0.05], dims="V_lp")
        settings["times"] = xr.DataArray([[0.03, 0.04], [0.0, 0.05]], dims=("V_lp", "time"))
    call = FUNCTIONS[function]
    many = call(slider(law, M=M, **own), V_lp, **settings)
    for i, j in ((0, 0), (1, 1), (2, 0)):
        there = {name: value.values[j] for name, value in settings.items()}
        one = call(slider(law, M=float(M[i]), **own), float(V_lp[j]), **there)
        case = many.isel(M=i, V_lp=j)
        assert case.sizes == one.sizes
        for name in one.data_vars:
            if one[name].dtype.kind in "fc" and "error" not in name:
                np.testing.assert_allclose(
                    case[name], one[name], rtol=1e-6, atol=1e-9, err_msg=name
                )
            elif name != "steps":
                np.testing.assert_array_equal(case[name], one[name], err_msg=name)


@pytest.mark.parametrize("name", ["method", "loading", "area", "foo"])
def test_what_is_not_a_recorded_parameter_is_refused(name):
    result = run(slider("aging"), 1e-3)
    with pytest.raises(rs.ParameterError, match=f"does not record {name}"):
        parameter(result, name)
