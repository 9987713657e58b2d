"""Results whose attributes or variables were lost or altered: ParameterError, or an answer."""

import json
import random
import re

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

import ratestate as rs
from ratestate import ParameterError, files, plot
from ratestate.dynamics.results import parameter
from ratestate.scenario import from_result, python, toml

SLIDER = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=5e8, M=3e3)
M = xr.DataArray([1e3, 3e3], dims="M")
STEP = rs.Loading.steps(1e-4, (0.05, 3e-3))


def fitted():
    slider = rs.SpringSlider(a=0.01, b=0.012, Dc="10 um", sigma="5 MPa", K="5 GPa/m")
    step = rs.Loading.steps("1 um/s", (100.0, "10 um/s"))
    run = rs.simulate(slider, step, 140.0, times=np.linspace(0, 140, 701))
    noise = 1e-4 * np.random.default_rng(1).normal(size=701)
    record = run[["delta_lp"]].assign(friction=run.tau / slider.sigma + noise)
    record.attrs |= {"source": "p1.txt", "notes": '["one"]', "found": "a step", "columns": "{}"}
    return rs.fit(record, slider)


RESULTS = {
    "run": lambda: rs.simulate(SLIDER, STEP, 0.1),
    "runs": lambda: rs.simulate(
        SLIDER.replace(M=M), STEP, 0.1, initial={"theta": 1.0}, times=[0.0, 0.05, 0.1]
    ),
    "wave": lambda: rs.simulate(
        SLIDER, rs.Loading.sinusoid(1e-3, 1e-4, period=0.01, t_end=0.02), 0.01, times=[0.0, 0.01]
    ),
    "record": lambda: rs.simulate(
        SLIDER, rs.Loading.series(np.linspace(0, 1, 1200), np.full(1200, 1e-3)), 1e-3, V_start=1e-4
    ),
    "cycle": lambda: rs.limit_cycle(SLIDER, 1e-3),
    "cycles": lambda: rs.limit_cycle(SLIDER.replace(M=M), rs.logspace("V_lp", 1e-3, 2e-3, 2)),
    "stability": lambda: rs.stability(SLIDER, 1e-3),
    "branch in K": lambda: rs.continue_cycle(SLIDER, "K", 5e8, 5.2e8, V_lp=1e-3, rtol=1e-6),
    "fit": fitted,
}
#: what may stand in any attribute
VALUES = {
    "number": 3,
    "nan": np.nan,
    "long": 10**400,
    "none": None,
    "bytes": b"\xff",
    "texts": np.array(["a", "b"]),
    "text": "three",
    "half": '{"a": ',
    "null": "null",
    "JSON list": "[]",
    "JSON dict": "{}",
    "JSON long": "1" * 5000,
    "deep": "[" * 100_000 + "]" * 100_000,
    "other parameter": "b",
}
#: those that are tried where one takes long
FEW = ("gone", "number", "texts", "text", "JSON list", "JSON dict", "deep")
#: what may stand within JSON, in place of any value of it
INNER = [
    *(None, True, -1.0, float("nan"), 10**400, "three", [], {}, [[1.0], [2.0]], 1e300),
    *({"dims": ["M"], "values": [1.0]}, {"variable": "M"}, {"dims": 3, "values": [1.0]}),
    *({"dims": ["q"], "values": ["a"]}, {"dims": [], "values": 1e3}, {"values": [1.0]}, [1.0, "a"]),
]


def places(value, path=()):
    """All places within JSON, but of a list only the first and the last."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield (*path, key)
            yield from places(inner, (*path, key))
    elif isinstance(value, list) and value:
        for i in {0, len(value) - 1}:
            yield (*path, i)
            yield from places(value[i], (*path, i))


def with_inner(text, path, inner):
    whole = json.loads(text)
    part = whole
    for key in path[:-1]:
        part = part[key]
    if inner == "gone":
        del part[path[-1]]
    else:
        part[path[-1]] = inner
    return json.dumps(whole)


def altered(results, kind, names, values):
    """(what was done, result) for every change of attributes of these names."""
    attrs, rng = results[kind].attrs, random.Random(f"{kind} 13")
    for name in names:
        value, changes = attrs[name], {what: VALUES[what] for what in values if what != "gone"}
        if values is VALUES:
            others = {k: one.attrs[name] for k, one in results.items() if name in one.attrs}
            changes |= {f"of {k}": other for k, other in others.items()}
        if values is VALUES and value[:1] in "{[":
            for path in places(json.loads(value)):
                for inner in (rng.choice(INNER), "gone"):
                    changes[f"{path} {inner!r}"[:200]] = with_inner(value, path, inner)
        yield f"{name} gone", {k: v for k, v in attrs.items() if k != name}
        yield from ((f"{name} {what}", attrs | {name: other}) for what, other in changes.items())


def failures(reader, results, kind, names, values=VALUES):
    """What was done -> what was raised that is no `ParameterError`."""
    found = {}
    for what, attrs in altered(results, kind, names, values):
        result = results[kind].copy()
        result.attrs = attrs
        try:
            reader(result)
        except ParameterError:
            continue
        except Exception as error:
            found[what] = f"{type(error).__name__}: {error}"
    return found


def write_scenario(result):
    for written in (toml, python):
        written(from_result(result))


def read_parameters(result):
    for symbol in ("sigma", "law"):
        parameter(result, symbol)


@pytest.fixture(scope="module")
def results():
    return {kind: make() for kind, make in RESULTS.items()}


@pytest.mark.parametrize("kind", ["runs", "wave", "record", "cycle", "stability", "branch in K"])
def test_altered_attributes_are_refused_or_read(kind, results):
    names = [*results[kind].attrs] if kind in ("runs", "cycle") else ["scenario"]
    for reader in (write_scenario, read_parameters):
        reader(results[kind])
        assert not failures(reader, results, kind, names)


@pytest.mark.parametrize(
    ("reader", "names", "values"),
    [
        (read_parameters, ["slider"], VALUES),
        (rs.fitted_slider, ["title", "slider"], VALUES),
        (rs.summary, ["source", "found", "notes"], FEW),
    ],
)
def test_altered_attributes_of_a_fit_are_refused_or_read(reader, names, values, results):
    reader(results["fit"])
    assert not failures(reader, results, "fit", names, values)


#: result -> the figure that is drawn of it
DRAWN = dict.fromkeys(["run", "cycle", "cycles", "stability", "fit"], plot.figure) | {
    "wave": lambda run: plot.trace(run, Figure().subplots()),
    "record": lambda run: plot.phase(run, Figure().subplots()),
    "branch in K": lambda data: plot.branch(data, Figure().subplots()),
}


@pytest.mark.parametrize("kind", DRAWN)
def test_altered_attributes_of_a_figure_are_refused_or_drawn(kind, results):
    names = {"fit": ["slider", "loading"]}.get(kind, ["title", "scenario"])
    assert not failures(DRAWN[kind], results, kind, names, FEW)


@pytest.mark.parametrize("ending", ["nc", "zarr"])
def test_altered_results_in_files_are_refused(ending, results, tmp_path):
    """Parts of complex numbers in NetCDF, and units of time, are looked at by `files.read`."""
    whole = files.stored.split(results["cycle"])
    parts = [name for name in whole.variables if re.fullmatch("multipliers_(real|imag)", name)]
    name, other = sorted(parts, reverse=True)
    assert (name, other) == ("multipliers_real", "multipliers_imag")
    changed = [
        whole.drop_vars(other),
        whole.rename({name: "real"}),
        whole.assign({name: whole[name].drop_attrs().assign_attrs(part="real")}),
        whole.assign({other: whole[other].isel({whole[other].dims[0]: 0})}),
        whole.assign(period=whole.period.assign_attrs(units="days since never")),
        whole.assign(period=whole.period.assign_attrs(scale_factor="two")),
    ]
    for i, data in enumerate(changed[4:] if ending == "zarr" else changed):
        path = tmp_path / f"{i}.{ending}"
        if ending == "nc":
            data.to_netcdf(path, engine="h5netcdf")
        else:
            data.drop_encoding().to_zarr(path, zarr_format=3, consolidated=False)
        with pytest.raises(ParameterError, match=rf"{i}\.{ending} cannot|cannot be joined"):
            files.read(path)


def test_a_loading_that_is_no_history_is_refused(results):
    """Each condition on the calls of a loading, alone."""
    written = json.loads(results["run"].attrs["scenario"])
    first, step = written["loading"]
    for calls, message in (
        ([], "has been changed"),
        ([step], "has been changed"),
        ([first, ["covers", {"t_end": 1.0}]], "has been changed"),
        ([first, ["step", {"t": 0.1}]], "has been changed"),
        ([["constant", {"V_lp": "gone"}]], "is not a number with a unit"),
        ([["constant", {"V_lp": -1e-4}]], "must be >= 0"),
        ([first, step, step], "must come after"),
    ):
        altered = json.dumps(written | {"loading": calls})
        with pytest.raises(ParameterError, match=message):
            from_result(results["run"].assign_attrs(scenario=altered))
