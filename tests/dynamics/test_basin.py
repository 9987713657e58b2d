"""escape: against plain marching, closed forms without inertia, and the branch of cycles."""

import functools
import itertools

import numpy as np
import pytest
import xarray as xr

import ratestate as rs
from ratestate import Loading, continue_cycle, limit_cycle, simulate
from ratestate.dynamics import basin
from ratestate.dynamics.basin import escape
from ratestate.engine.model import NO_CONVERGENCE

FIG2 = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, mu0=0.6, V0=1e-9, sigma=2e6, M=3e3, K=9e8)
# Aging law, K just above K_c_qs: between a fold at 0.33 mm/s and V_c = 0.447 mm/s stable sliding
# and cycles coexist
STRIP = FIG2.replace(K=6.06e8, law="aging")
FOLD = 3.298416815e-4
V_LP = 3.6e-4
MASSLESS = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, M=0, K=6.3e8)
LAWS = pytest.mark.parametrize("law", ["slip", "aging"])
STEPS, KICKS = ["step_up", "step_down"], ["kick_up", "kick_down"]
CYCLES = ["amplitude", "period", "unstable_amplitude", "unstable_period", "unstable_multiplier"]


@functools.cache
def edge():
    return escape(STRIP, V_LP)


#: V_lp beyond the fold and just inside the strip, on the way to the Hopf point, and beyond that
SPEEDS = [
    *(FOLD * (1 - 1e-4), FOLD * (1 + 1e-4)),
    *(STRIP.V_c * (1 - 1e-1), STRIP.V_c * (1 - 1e-2), STRIP.V_c * (1 + 1e-6)),
]


@functools.cache
def edges():
    """`escape` at all `SPEEDS` at once."""
    return escape(STRIP, xr.DataArray(SPEEDS, dims="V_lp"))


def disturbed(slider, V_lp, name, sizes, t_end, **settings):
    """Runs that begin with disturbances of these sizes, V_lp/V or a change of tau [Pa]."""
    loading, sizes = Loading.constant(V_lp), xr.DataArray(sizes, dims="size")
    if name in STEPS:
        return simulate(slider, loading, t_end, V_start=V_lp / sizes, **settings)
    tau = slider.sigma * (slider.mu0 + (slider.a - slider.b) * np.log(V_lp / slider.V0))
    start = {"theta": slider.Dc / V_lp, "tau": tau + sizes}
    start |= {"V": V_lp} if slider.M > 0 else {}
    return simulate(slider, loading, t_end, V_start=V_lp, initial=start, **settings)


@pytest.mark.parametrize("name", ["step_up", *KICKS])
def test_against_plain_marching(name):
    """A little less comes to rest in steady sliding, a little more in the limit cycle."""
    size, period = float(edge()[name]), float(edge().unstable_period)
    off = np.array([-1e-2, -1e-6, 1e-6, 1e-2])
    sizes = size ** (1 + off) if name in STEPS else size * (1 + off)
    runs = disturbed(STRIP, V_LP, name, sizes, 1600 * period, rtol=1e-9)
    amplitude = runs.amplitude / float(edge().amplitude)
    assert (amplitude[:2] < 2e-2).all()
    assert amplitude[2:].values == pytest.approx([1, 1], abs=1e-3)
    assert edge().outcome == "cycle"
    assert edge().step_up > 1
    assert edge().kick_up > 0 > edge().kick_down


def test_every_step_down_from_stable_sliding_decays():
    """From the fastest stable steady sliding, V_c, to V_lp: the largest step down there is."""
    assert edge().step_down == 0
    ratio = V_LP / STRIP.V_c
    period = float(edge().unstable_period)
    runs = disturbed(STRIP, V_LP, "step_down", [ratio, 0.99 * ratio + 0.01], 900 * period)
    assert (runs.amplitude < 0.05 * edge().amplitude).all()


def test_both_cycles_lie_on_the_branch():
    """limit_cycle's, and the other end of the branch through the fold, here in V_lp."""
    stable = limit_cycle(STRIP, V_LP)
    for name in ("amplitude", "period"):
        assert float(edge()[name]) == pytest.approx(float(stable[name]), rel=1e-6)
    branch = continue_cycle(STRIP, "V_lp", V_LP, 1e-4)
    assert branch.special[-1] == "start"
    for name in ("amplitude", "period"):
        expected = float(branch[name][-1])
        assert float(edge()[f"unstable_{name}"]) == pytest.approx(expected, rel=1e-6)
    multiplier = float(branch.multipliers[-1, 0].real)
    assert float(edge().unstable_multiplier) == pytest.approx(multiplier, rel=1e-6)
    assert edge().unstable_amplitude < edge().amplitude
    assert edge().unstable_multiplier > 1


def test_up_to_the_hopf_point():
    """The threshold goes to 0 as the square root of the distance, with the unstable cycle."""
    distance, found = np.array([1e-1, 1e-2]), edges().isel(V_lp=[2, 3])
    assert (found.outcome == "cycle").all()
    coefficient = float(rs.hopf(STRIP).amplitude_coefficient)
    ratio = found.unstable_amplitude.values / coefficient / np.sqrt(distance)
    assert (np.abs(ratio - 1) < distance).all()
    assert (ratio > 1).all()
    for size in (np.log(found.step_up), found.kick_up, -found.kick_down):
        exponent = np.diff(np.log(size)) / np.diff(np.log(distance))
        assert (np.abs(exponent - 0.5) < 0.08).all()
    assert found.unstable_multiplier.values[-1] == pytest.approx(1.0012292, abs=1e-6)
    assert found.unstable_multiplier[0] > found.unstable_multiplier[1]


def test_where_the_strip_begins_and_ends():
    """Beyond the fold nothing leaves; at V_c and above there is no steady sliding to leave."""
    found = edges().isel(V_lp=[0, 1, 3, 4])
    assert found.outcome.values.tolist() == ["none", "cycle", "cycle", "no steady sliding"]
    np.testing.assert_array_equal(found.step_up[[0, 3]], [np.inf, 1.0])
    np.testing.assert_array_equal(found.step_down[[0, 3]], [0.0, 1.0])
    np.testing.assert_array_equal(found.kick_up[[0, 3]], [np.inf, 0.0])
    np.testing.assert_array_equal(found.kick_down[[0, 3]], [-np.inf, 0.0])
    for name in CYCLES:
        assert np.isfinite(found[name]).values.tolist() == [False, True, True, False], name
    # at the fold the two cycles meet
    ratio = found.unstable_amplitude / found.amplitude
    assert 0.97 < ratio[1] < 1
    assert ratio[2] < 0.12
    assert 1 < found.unstable_multiplier[1] < 1.003


@LAWS
@pytest.mark.parametrize(
    "changes",
    [
        {"b": 0.003},
        {"b": 0.002},
        {"b": -0.001},
        {"K": np.inf},
        {"K": np.inf, "M": 0.0},
        {"K": 1e10},
        {},  # V_lp below V_c, eta too large for coexistence
    ],
    ids=["b = a", "b < a", "b < 0", "K = inf", "K = inf, M = 0", "stiff", "supercritical"],
)
def test_no_disturbance_leaves_sliding_that_is_always_stable(changes, law):
    found = escape(FIG2.replace(law=law, **changes), 1e-3)
    assert found.outcome == "none"
    assert found.step_up == found.kick_up == -found.kick_down == np.inf
    assert found.step_down == 0
    for name in CYCLES:
        assert np.isnan(found[name]), name


@LAWS
@pytest.mark.parametrize("changes", [{"K": 5e8}, {"K": 5e8, "M": 0.0}, {"K": 6e8, "M": 1e3}])
def test_no_steady_sliding(changes, law):
    found = escape(FIG2.replace(law=law, **changes), 1e-3)
    assert found.outcome == "no steady sliding"
    assert found.step_up == found.step_down == 1
    assert found.kick_up == found.kick_down == 0
    for name in CYCLES:
        assert np.isnan(found[name]), name


def test_without_inertia_the_aging_law_comes_back():
    """Above K_c_qs from every start, by way of whatever speed."""
    K = xr.DataArray(MASSLESS.K_c_qs * np.array([1.001, 1.5, 2.0, 10.0]), dims="K")
    found = escape(MASSLESS.replace(K=K, law="aging"), 1e-9)
    assert (found.step_up == np.inf).all()
    assert (found.step_down == 0).all()
    assert (found.kick_up == np.inf).all()
    assert (found.outcome == "none").all()


def test_a_search_that_does_not_converge_has_an_unknown_outcome(monkeypatch):
    """A motion that decays slowly is not irregular; one whose amplitude goes up and down is."""

    def escapes(system, kind, largest, progress):
        return np.arange(1.0, 5.0), np.full(4, NO_CONVERGENCE), np.full((4, 2), 0.01)

    monkeypatch.setattr(basin, "_search", escapes)
    slow = STRIP.replace(K=xr.DataArray([6.06e8], dims="K"))
    found = escape(slow, V_LP)
    assert found.outcome.values.tolist() == ["unknown"]
    assert np.isnan([found[name].values for name in (*STEPS, *KICKS)]).all()
    turns = itertools.cycle([0.02, 0.01])
    monkeypatch.setattr(basin, "small_amplitude", lambda system, u: next(turns))
    assert escape(slow, V_LP).outcome.values.tolist() == ["irregular cycles"]


def near_its_edge(law, M, K_over_K_c, **own):
    """A slider at this multiple of K_c at V_LP, under a law that has these parameters alone."""
    slider = FIG2.replace(M=M, law=law, **own)
    return slider.replace(K=K_over_K_c * slider.K_c(V_LP))


@pytest.mark.parametrize(
    ("law", "own"),
    [
        ("nagata", {"c": 1.0}),
        ("kato-tullis", {"V_cut": 1e-2}),
    ],
)
def test_runaways_of_any_law_against_plain_marching(law, own):
    """Without mass; where the law knows no edge of runaway in closed form."""
    slider = near_its_edge(law, 0.0, 1.02, **own)
    found = escape(slider, V_LP)
    assert found.outcome == "runaway"
    assert found.step_down == 0  # (nor does any run from V_c, inf, leave)
    for name in ("step_up", *KICKS):
        size = float(found[name])
        sizes = size ** (1 + OFF) if name in STEPS else size * (1 + OFF)
        loading, t_end = Loading.constant(V_LP), 3e3 * slider.Dc / V_LP
        for k, part in enumerate(sizes):
            start = {"V_start": V_LP / part} if name in STEPS else kicked(slider, part)
            if OFF[k] > 0:
                with pytest.raises(rs.QuasiStaticInstability):
                    simulate(slider, loading, t_end, rtol=1e-9, **start)
            else:
                run = simulate(slider, loading, t_end, rtol=1e-9, **start)
                assert abs(float(run.V[-1]) / V_LP - 1) < 1e-3


OFF = np.array([-1e-2, -1e-5, 1e-5, 1e-2])


def kicked(slider, change):
    """Arguments of a run from steady sliding at V_LP, whose stress then changes by so much [Pa]."""
    steady = simulate(slider, Loading.constant(V_LP), 1e-9, V_start=V_LP).isel(time=0)
    states = {name: float(steady[name]) for name in slider.friction_law.states}
    if slider.law == "nagata":  # b ln theta + c mu is continuous, not theta
        factor = np.exp(-slider.c * change / slider.sigma / slider.b)
        states["theta"] *= factor
    initial = states | {"tau": float(steady.tau) + change}
    return {"V_start": V_LP, "initial": initial}


def test_steps_where_sliding_is_stable_above_the_unstable_speeds():
    """No step up comes from a speed at which sliding is unstable; one down may lead to runaway."""
    slider = FIG2.replace(M=0.0, K=6.3e8, law="kato-tullis", V_cut=1e-4)
    V_lp = 1.2 * slider.V_c_upper
    found = escape(slider, V_lp)
    assert found.outcome == "runaway"
    assert found.step_up == np.inf
    loading = Loading.constant(V_lp)
    slowest = simulate(slider, loading, 20.0, V_start=1.0001 * slider.V_c_upper, rtol=1e-9)
    assert float(slowest.V[-1]) == pytest.approx(V_lp, rel=1e-3)
    with pytest.raises(rs.QuasiStaticInstability):  # from slower sliding, were it stable
        simulate(slider, loading, 20.0, V_start=0.1 * slider.V_c_upper, rtol=1e-9)
    down = V_lp / float(found.step_down)
    run = simulate(slider, loading, 20.0, V_start=0.999 * down, rtol=1e-9)
    assert float(run.V[-1]) == pytest.approx(V_lp, rel=1e-3)
    with pytest.raises(rs.QuasiStaticInstability):
        simulate(slider, loading, 20.0, V_start=1.001 * down, rtol=1e-9)
