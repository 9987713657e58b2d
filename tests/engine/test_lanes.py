"""The same bits wherever a slider marches: lane, batch, order, threads, or alone."""

import threading
from fractions import Fraction
from typing import NamedTuple

import numpy as np
import pytest
import xarray as xr
from machine_control import Machine
from synthetic_records import SLIDER, STEP, record

import ratestate as rs
from ratestate.dynamics.basin import escape
from ratestate.dynamics.simulation.simulate import SimulateCall
from ratestate.engine import backend, dispatch, lanes, machine_code, programs
from ratestate.engine import rows as R
from ratestate.engine.lanes import control_step
from ratestate.engine.programs import units_of
from ratestate.engine.rows import call_lanes
from ratestate.engine.units import MarchUnits
from ratestate.friction.laws import LAWS as FORMULAS
from ratestate.friction.laws import friction_law
from ratestate.friction.point import Point

LAWS = pytest.mark.parametrize("law", ["slip", "aging"])
NAMES = ["V", "theta", "tau", "delta", "mu", "status", "steps", "energy_residual", "V_max", "V_min"]
NAMES += ["inertial_force", "mu_min", "reversal_margin", "outside_domain", "amplitude", "frequency"]
NAMES += ["cycles"]
TIMES = np.array([0.0, 0.4, 0.8])
LOADING = rs.Loading.steps(1e-4, (0.02, 3e-3), (0.1, 0.0), (0.3, 1e-2))


def cases(n, seed=11):
    """Return cases of mixed length and fate: stiff or not, without mass, failing."""
    rng = np.random.default_rng(seed)
    a = 10 ** rng.uniform(-2.7, -1.5, n)
    M = np.where(rng.random(n) < 0.2, 0.0, 10 ** rng.uniform(0, 5, n))
    K = (rng.uniform(0.1, 2, n) - 0.1 * (M > 0)) * 0.8 * a * 2e6 / 1e-5 + 1e6
    return {"a": a, "b": 1.8 * a, "M": M, "K": K}, rng.uniform(0.05, 0.5, n)


def run(parameters, t_end, law="slip", pick=None):
    pick = np.arange(len(t_end)) if pick is None else np.asarray(pick)
    arrays = {k: xr.DataArray(v[pick], dims="case") for k, v in parameters.items()}
    slider = rs.SpringSlider(**arrays, Dc=1e-5, sigma=2e6, V0=1e-9, law=law)
    ends = xr.DataArray(t_end[pick], dims="case")
    times = ends * xr.DataArray(TIMES, dims="time")
    return rs.simulate(slider, LOADING, ends, times=times, rtol=1e-6)


def same(one, other):
    for name in NAMES:
        np.testing.assert_array_equal(one[name].values, other[name].values, err_msg=name)


class Commits(NamedTuple):
    """Lanes, and a law's unit that commits their steps."""

    commit: int
    s: np.ndarray


def commit_often(run, n):
    for _ in range(n):
        call_lanes(run.commit, run.s, 0, 1)
    return True


def test_a_million_steps_lose_no_time():
    """Time is known to twice the digits of its first part: 1e6 steps of 0.1 are its 1e6-fold."""
    law = FORMULAS["aging"]
    s = np.zeros(R.rows_of(law).size)
    s[R.H_USED], s[R.OK], s[R.BREAKPOINT] = 0.1, 1.0, np.inf
    assert Machine(commit_often, Commits(units_of(law, MarchUnits, 1).commit, s))(10**6)
    exact = 10**6 * Fraction(0.1)
    off = Fraction(s[R.T]) + Fraction(s[R.T_LOW]) - exact
    assert abs(off) < 1e-20 * exact
    assert abs(Fraction(s[R.T]) - exact) <= np.spacing(1e5) / 2  # the low part is but the rest
    assert s[R.STEPS] == 1e6


@pytest.mark.parametrize("where", range(6))
@pytest.mark.parametrize("wrong", [0.0, np.nan, np.inf])
def test_a_step_that_is_not_finite_is_rejected(where, wrong):
    """Whichever of its numbers is none: of that and another, max may give the other."""
    law, l = friction_law("slip"), 5
    rows = R.rows_of(law)
    s = np.ones(rows.size)
    s[np.add(rows.p, l)] = 1.5
    s[R.TOLERANCE + l] = 1e-6
    y, error = [[2.0, 0.0, 0.5], [3e-7, 0.0, 1e-7]]
    (error if where < 3 else y)[where % 3] += wrong
    dense = ((0.0,) * R.RODAS5P_TERMS,) * 3
    lanes.store_step(s, l, 0.1, Point(law, (1.5, 1.5), tuple(y), 1.0, ()), tuple(error), dense)
    control_step(s, l)
    assert s[R.OK + l] == (wrong == 0.0)
    assert s[R.BAD + l] == (wrong != 0.0)
    if wrong == 0.0:
        assert s[R.ERROR + l] == pytest.approx(0.3, rel=1e-12)


def test_a_rigid_limit_cycle_loads_no_kernel(monkeypatch):
    """There is no cycle with K = inf."""
    monkeypatch.setattr(dispatch, "Program", None)
    rigid = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, M=3e3, K=np.inf)
    assert float(rs.limit_cycle(rigid, 1e-3).status) == 1


@pytest.fixture(scope="module")
def reference():
    everything = {}
    for law in ("slip", "aging"):
        found = run(*cases(40), law)
        codes = set(found.status.values.tolist())
        assert {0, 5} <= codes  # both fates are among them
        everything[law] = found
    return everything


@LAWS
@pytest.mark.parametrize("n", [2, 15, 16, 17, 33])
def test_results_do_not_depend_on_order_and_size(reference, law, n):
    pick = np.random.default_rng(n).permutation(40)[:n]
    same(run(*cases(40), law, pick), reference[law].isel(case=pick))


@LAWS
@pytest.mark.parametrize("cores", [1, 3])
def test_results_do_not_depend_on_threads(reference, law, cores, monkeypatch):
    monkeypatch.setattr(dispatch, "cores", lambda: cores)
    pick = np.append(np.full(35, 7), np.tile(np.arange(40), 4))  # enough sets of lanes, in each 7
    same(run(*cases(40), law, pick), reference[law].isel(case=pick))


@pytest.mark.parametrize("times", [None, np.array([1e7])])
def test_a_single_run_is_stopped_between_two_budgets(times):
    """Whether each step is kept or not; to its end this one would take an hour."""
    stop = threading.Event()
    slider = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, M=3e3, K=4.8e8)
    call = SimulateCall(slider, rs.Loading.constant(1e-4), 1e7, V_start=1e-5, times=times)
    with backend.use(stop=stop), pytest.raises(backend.Stopped):
        call.move(lambda fraction: stop.set())


@LAWS
def test_a_slider_alone_has_the_bits_of_its_batch(reference, law):
    """A slider in a call of its own."""
    parameters, t_end = cases(40)
    for i in range(0, 40, 3):
        batch = reference[law].isel(case=i)
        slider = rs.SpringSlider(
            **{k: float(v[i]) for k, v in parameters.items()}, Dc=1e-5, sigma=2e6, V0=1e-9, law=law
        )
        end = float(t_end[i])
        if batch.status != 0:
            with pytest.raises(rs.SolverError):
                rs.simulate(slider, LOADING, end)
            continue
        same(rs.simulate(slider, LOADING, end, times=end * TIMES, rtol=1e-6), batch)


def test_code_is_made_once(monkeypatch):
    """Arrays of another layout or origin need no other: it is of laws, and of the control."""
    slider = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=6.06e8, M=3e3, law="aging")
    fitted = record(SLIDER, STEP, np.linspace(0.0, 140.0, 400), noise=1e-4)

    def work(times, n):
        for one in (slider, slider.replace(M=rs.logspace("M", 3e3, 3.1e3, n))):
            rs.limit_cycle(one, 1e-2)
            rs.simulate(one, rs.Loading.constant(1e-2), 1e-3, V_start=9e-3, times=times)
        escape(slider, 3.6e-4)
        rs.fit(fitted, SLIDER, errors="covariance")

    work(np.linspace(0.0, 1e-3, 5), 2)
    before = list(programs._functions)
    of_records = [(f, *(one for one in kinds if isinstance(one[0], str))) for f, kinds in before]
    assert len(set(of_records)) == len(before)  # each for one kind of record
    monkeypatch.setattr(machine_code, "cached_code", None)
    work(np.linspace(0.0, 1e-3, 9)[::2], 3)
    assert list(programs._functions) == before
