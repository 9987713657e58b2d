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
    "branch": lambda: rs.continue_cycle(SLIDER.replace(K=9e8), "V_lp", 3.5e-3, 3e-3, rtol=1e-6),
    "branch in K": lambda: rs.continue_cycle(SLIDER, "K", 5e8, 5.2e8, V_lp=1e-3, rtol=1e-6),
    "sweep": lambda: rs.sweep("stability", SLIDER.replace(M=M), V_lp=1e-3),
    "fit": fitted,
}


def deep(levels):
    return "[" * levels + "]" * levels


#: what may stand in any attribute
VALUES = {
    "number": 3,
    "negative": -1.0,
    "nan": np.nan,
    "inf": np.inf,
    "huge": 1e308,
    "long": 10**400,
    "none": None,
    "bytes": b"\xff",
    "array": np.arange(3.0),
    "texts": np.array(["a", "b"]),
    "yes": True,
    "list": [1, "a", None],
    "empty": "",
    "text": "three",
    "half": '{"a": ',
    "null": "null",
    "JSON list": "[]",
    "JSON dict": "{}",
    "JSON nan": "NaN",
    "JSON number": "-7",
    "JSON long": "1" + "0" * 400,
    "JSON longer": "1" * 5000,
    "deep": deep(100_000),
    "deep dict": '{"a":' * 50_000,
    "other symbol": "tau",
    "other parameter": "b",
    "long text": "x" * 100_000,
}
#: of those some
FEW = ("gone", "number", "nan", "texts", "text", "null", "JSON list", "JSON dict", "deep")
#: what may stand within JSON, in place of any value of it
INNER = [
    *(None, True, -1.0, 0.0, float("nan"), float("inf"), 10**400, "three", [], {}, [[1.0], [2.0]]),
    *({"dims": ["M"], "values": [1.0]}, {"variable": "M"}, {"variable": "V"}),
    *({"dims": 3, "values": [1.0]}, {"dims": ["q"], "values": ["a"]}, {"dims": [], "values": 1e3}),
    *({"dims": ["time"], "values": [1.0]}, {"values": [1.0]}, [1.0, "a"], [float("nan")], 1e300),
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


def with_attrs(result, attrs):
    result = result.copy()
    result.attrs = attrs
    return result


def altered(results, kind, few=1):
    """(what was done, attributes) for every attribute of a result, and changes to it.

    few : changes, drawn at random, of each place within JSON
    """
    attrs, rng = results[kind].attrs, random.Random(f"{kind} 13")
    others = {k: results["runs"].attrs[k] for k in ("title", "scenario")}
    for name, value in attrs.items():
        yield f"{name} gone", {k: v for k, v in attrs.items() if k != name}
        for what, other in VALUES.items():
            yield f"{name} {what}", attrs | {name: other}
        for one in results.values():
            if name in one.attrs:
                yield f"{name} another's", attrs | {name: one.attrs[name]}
        for other, text in others.items():
            yield f"{name} is {other}", attrs | {name: text}
        if isinstance(value, str) and value[:1] in "{[":
            for path in places(json.loads(value)):
                for inner in [*rng.sample(INNER, few), "gone"]:
                    what = f"{name} {path} {inner!r}"[:200]
                    yield what, attrs | {name: with_inner(value, path, inner)}


def foreign(reader, result):
    """What a reader raises that is no `ParameterError`, as text; "" if nothing."""
    try:
        reader(result)
    except ParameterError:
        return ""
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    return ""


def scenario_of(result):
    for written in (toml, python):
        written(from_result(result))


def parameters_of(result):
    for symbol in ("sigma", "law"):
        parameter(result, symbol)


@pytest.fixture(scope="module")
def results():
    return {kind: make() for kind, make in RESULTS.items()}


def failures(reader, results, kind, changes):
    """What was done -> what was raised that is no `ParameterError`."""
    found = {what: foreign(reader, with_attrs(results[kind], attrs)) for what, attrs in changes}
    return {what: error for what, error in found.items() if error}


#: of every function one, and a loading of each kind; the attributes that others above lack
SOME = {
    "runs": None,
    "wave": ("scenario",),
    "record": ("scenario",),
    "cycle": None,
    "stability": ("scenario",),
    "branch in K": ("scenario",),
}
ALL = [pytest.param(kind, None, marks=pytest.mark.statistics) for kind in RESULTS if kind != "fit"]


@pytest.mark.parametrize(("kind", "names"), [*SOME.items(), *ALL])
def test_altered_attributes(kind, names, results):
    changes = [one for one in altered(results, kind) if not names or one[0].split()[0] in names]
    assert len(changes) > 30
    for reader in (scenario_of, parameters_of):
        reader(results[kind])
        assert not failures(reader, results, kind, changes)


def test_altered_attributes_of_a_fit(results):
    readers = {
        parameters_of: ("slider",),
        rs.fitted_slider: ("title", "slider"),
        rs.summary: ("source", "found", "notes", "comparison"),
    }
    for reader, names in readers.items():
        reader(results["fit"])
        changes = [one for one in altered(results, "fit") if one[0].split()[0] in names]
        changes = [one for one in changes if " is " not in one[0]]
        if reader is rs.summary:  # which takes long
            changes = [one for one in changes if one[0].split()[1] in FEW]
        assert not failures(reader, results, "fit", changes)


#: figure -> the result that it is of, and the attributes that it looks at
DRAWN = {
    "run": (plot.figure, ("title", "scenario")),
    "cycle": (plot.figure, ("title", "scenario")),
    "cycles": (plot.figure, ("title", "scenario")),
    "stability": (plot.figure, ("title", "scenario")),
    "branch": (plot.figure, ("title", "scenario")),
    "fit": (plot.figure, ("slider", "loading")),
    "wave": (lambda run: plot.trace(run, Figure().subplots()), ("scenario",)),
    "record": (lambda run: plot.phase(run, Figure().subplots()), ("scenario",)),
    "branch in K": (lambda data: plot.branch(data, Figure().subplots()), ("scenario",)),
}


@pytest.mark.parametrize("kind", DRAWN)
def test_altered_attributes_of_what_is_drawn(kind, results):
    draw, names = DRAWN[kind]
    wanted = {f"{name} {what}" for name in names for what in FEW}
    changes = [one for one in altered(results, kind) if one[0] in wanted]
    assert len(changes) == len(wanted)
    assert not failures(draw, results, kind, changes)


@pytest.mark.parametrize("ending", ["nc", "zarr"])
def test_altered_results_in_files(ending, results, tmp_path):
    """What `files.read` itself looks at: parts of complex numbers in NetCDF, units of time."""
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
        with pytest.raises(ParameterError, match=rf"{i}\.{ending} cannot|not the parts of one"):
            files.read(path)


def test_a_loading_that_is_no_history(results):
    """Each condition on the calls of a loading, alone."""
    written = json.loads(results["run"].attrs["scenario"])
    first, step = written["loading"]
    for calls, message in (
        ([], "not as it was made"),
        ([step], "not as it was made"),
        ([first, ["covers", {"t_end": 1.0}]], "not as it was made"),
        ([first, ["step", {"t": 0.1}]], "not as it was made"),
        ([["constant", {"V_lp": "gone"}]], "is not a number with a unit"),
        ([["constant", {"V_lp": -1e-4}]], "must be >= 0"),
        ([first, step, step], "must come after"),
    ):
        altered = json.dumps(written | {"loading": calls})
        with pytest.raises(ParameterError, match=message):
            from_result(results["run"].assign_attrs(scenario=altered))
