"""continue_cycle: against limit_cycle, SciPy, closed forms of the Hopf point, and itself."""

import functools
import json

import naive
import numpy as np
import pytest
import xarray as xr

import ratestate as rs
from ratestate import NotConverged, ParameterError, continue_cycle, limit_cycle
from ratestate.dynamics.continuation import arclength
from ratestate.dynamics.continuation.family import PARAMETERS

FIG2 = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, mu0=0.6, V0=1e-9, sigma=2e6, M=3e3, K=9e8)
# Aging law, K just above K_c_qs: below V_c = 0.447 mm/s stable sliding and cycles coexist
STRIP = FIG2.replace(K=6.06e8, law="aging")
FOLD = 3.298416815e-4
# Slip law, b/a = 12.1: period doublings at 2.576e-3 and 8.775e-3 m/s
WILD = FIG2.replace(b=0.0363, K=1.06 * 0.0333 * 2e6 / 1e-5)
#: parameter -> (start, stop, V_lp, and the slider's K)
ACROSS = {
    "V_lp": (5e-3, 1e-4, None, 6.06e8),
    "K": (7e8, 3e8, 1e-3, 6.2e8),
    "M": (1e4, 1e2, 1e-2, 9e8),
    "sigma": (1e6, 6e6, 1e-3, 9e8),
    "a": (1e-3, 1e-2, 1e-3, 9e8),
    "b": (1e-3, 1.2e-2, 1e-3, 9e8),
    "Dc": (4e-6, 1e-2, 1e-3, 9e8),
}
#: The map of a branch knows parameters and laws apart: each parameter once, the speed by both laws
BY_SLIP = ("V_lp", "a", "b", "sigma")
BY_AGING = ("V_lp", *(p for p in PARAMETERS if p not in BY_SLIP))
SIDES = pytest.mark.parametrize(
    ("parameter", "law"),
    [(p, "slip") for p in BY_SLIP] + [(p, "aging") for p in BY_AGING],
)


@functools.cache
def across(parameter, law):
    """A branch with the Hopf point at one end; its slider and V_lp."""
    start, stop, V_lp, K = ACROSS[parameter]
    slider = FIG2.replace(K=K, law=law)
    return continue_cycle(slider, parameter, start, stop, V_lp=V_lp), slider, V_lp


@functools.cache
def strip(forth=True):
    """The branch through hopf, fold and on to 1 mm/s, or from there."""
    return continue_cycle(STRIP, "V_lp", *((1e-4, 1e-3) if forth else (1e-3, 1e-4)))


def specials(branch):
    return [name for name in branch.special.values if name]


def special(branch, name):
    """The only special point of this name."""
    (i,) = np.flatnonzero(branch.special == name)
    return branch.isel(point=i)


def bends(branch, parameter):
    """|d ln amplitude/d ln p| of each point, to its worse neighbour; inf at the ends."""
    with np.errstate(divide="ignore"):
        slope = np.diff(np.log(branch.amplitude)) / np.diff(np.log(branch[parameter]))
    return np.maximum(*(np.concatenate(ends) for ends in (([np.inf], slope), (slope, [np.inf]))))


def at(slider, parameter, values, V_lp):
    """The slider, or sweep of sliders, of these values, and its V_lp."""
    if parameter == "V_lp":
        return slider, values
    return slider.replace(**{parameter: values}), V_lp


@SIDES
def test_agrees_with_limit_cycle(parameter, law):
    """Where a cycle is stable, and reached from steady sliding, it is this one."""
    branch, slider, V_lp = across(parameter, law)
    bend = np.abs(bends(branch, parameter))
    plain = (branch.special != "hopf") & branch.stable
    branch, bend = branch.isel(point=plain)[{"point": slice(None, None, 4)}], bend[plain][::4]
    values = xr.DataArray(branch[parameter].values, dims="point")
    sweep, V = at(slider, parameter, values, V_lp)
    cycles = limit_cycle(sweep, V, rtol=1e-9)
    unstable = np.broadcast_to(sweep.K_c(V) > sweep.K, branch.stable.shape)
    assert unstable.sum() > 4
    reached = (cycles.status == 0).values
    assert reached[unstable].all()
    assert reached.sum() > 5
    allowed = {"period": 1e-7, "amplitude": 3e-5, "V_max": 3e-6, "V_min": 3e-6, "inertia": 3e-6}
    for name, most in allowed.items():
        off = np.abs(cycles[name].values / branch[name].values - 1)[reached]
        assert off.max() < most, name
    # an error of the parameter is one of the cycle at the parameter given
    off = np.abs(cycles.amplitude / branch.amplitude - 1).values
    known = reached & np.isfinite(bend)
    assert (off < 2 * branch.error * (1 + bend) + 1e-8)[known].all()
    for name, most in {"multipliers": 3e-7, "fundamental": 1e-7, "slow_fraction": 1e-6}.items():
        assert float(np.abs(cycles[name] - branch[name])[reached].max()) < most, name
    assert (cycles.stable[reached]).all()


@SIDES
def test_a_branch_has_its_ends_folds_and_hopf_point(parameter, law):
    """Between the end given, bit for bit, and the Hopf point, which is that of `hopf`."""
    branch, slider, V_lp = across(parameter, law)
    start, stop = ACROSS[parameter][:2]
    # aging law: eta at the Hopf point of M is 0.5, beyond the Bautin point, and of others < 0.1
    fold = ["fold"] if law == "aging" and parameter != "M" else []
    value = branch[parameter].values
    if branch.special[0] == "start":
        assert specials(branch) == ["start", *fold, "hopf"]
        assert value[0] == start
    else:
        assert specials(branch) == ["hopf", *fold, "stop"]
        assert value[-1] == stop
    hopf = special(branch, "hopf")
    at_hopf, V = at(slider, parameter, float(hopf[parameter]), V_lp)
    if parameter == "V_lp":
        expected = rs.hopf(at_hopf)
        assert float(expected.V_c) == pytest.approx(V, rel=1e-12)
    else:
        expected = rs.hopf(at_hopf, V_lp=V)
        assert float(expected.K_c) == pytest.approx(at_hopf.K, rel=1e-12)
    assert float(hopf.frequency) == pytest.approx(float(expected.frequency), rel=1e-12)
    assert float(hopf.period) == pytest.approx(1 / float(expected.frequency), rel=1e-12)
    assert hopf.amplitude == 0
    assert hopf.V_max == hopf.V_min == V
    third = np.exp(float(expected.eigenvalue_3 * hopf.period))
    assert hopf.multipliers.values == pytest.approx([1, third], rel=1e-9, abs=1e-300)
    assert str(expected.type.values) == ("subcritical" if fold else "supercritical")
    # what vanishes there does so continuously
    second = branch.isel(point=1 if branch.special[0] == "hopf" else -2)
    for name, most in {"period": 3e-3, "inertia": 3e-2, "fundamental": 3e-3}.items():
        assert float(second[name]) == pytest.approx(float(hopf[name]), rel=most), name
    assert float(second.multipliers[0].real) == pytest.approx(1, abs=5e-3)
    assert second.amplitude > 0
    assert second.V_max / V == pytest.approx(1, abs=0.05)


@SIDES
def test_multipliers_and_the_divergence(parameter, law):
    """Their product is exp(-(period + integral of exp(-v)/eta)), between two closed forms.

    Less than 1 everywhere: no cycle of this system loses its stability to a torus.
    """
    branch, slider, V_lp = across(parameter, law)
    branch = branch.isel(point=branch.special != "hopf")
    sliders, V = at(slider, parameter, branch[parameter].drop_vars(parameter), V_lp)
    eta = sliders.eta(V)
    turn = branch.period * V / sliders.Dc
    product = branch.multipliers.prod("multiplier")
    assert (np.abs(product.imag) < 1e-12).all()
    assert (product.real >= 0).all()
    with np.errstate(divide="ignore"):
        exponent = np.log(product.real)  # -inf where it underflows
    assert (exponent < -(1 + 1 / eta) * turn * (1 - 1e-6)).all()
    most = 1 + V / branch.V_min / eta
    assert ((exponent > -most * turn) | (most * turn > 700)).all()
    assert np.isfinite(exponent).any()


def test_fold():
    """A multiplier is 1, the branch turns back, and cycles exist on one side only."""
    fold = special(strip(), "fold")
    assert float(fold.V_lp) == pytest.approx(FOLD, rel=3e-8)
    assert fold.multipliers[0].real == pytest.approx(1, abs=1e-4)
    assert fold.multipliers[0].imag == 0
    i = int(np.flatnonzero(strip().special == "fold")[0])
    V = strip().V_lp.values
    assert (np.diff(V[: i + 1]) < 0).all()
    assert (np.diff(V[i:]) > 0).all()
    assert not strip().stable[1:i].any()
    assert strip().stable[i + 1 :].all()
    beside = xr.DataArray(float(fold.V_lp) * (1 + np.array([-3e-6, 3e-6])), dims="side")
    cycles = limit_cycle(STRIP, beside)
    assert cycles.status.values.tolist() == [1, 0]
    # amplitude - that of the fold ~ sqrt(distance)
    assert float(cycles.amplitude[1] / fold.amplitude) == pytest.approx(1, abs=0.02)


def test_unstable_cycles_against_scipy():
    """Newton's method on the return map in physical variables, by LSODA."""
    K, V_lp = STRIP.K, 4.2e-4
    branch = continue_cycle(STRIP, "K", K, 2 * K, V_lp=V_lp)
    assert specials(branch) == ["start", "fold", "start"]
    cycle = branch.isel(point=-1)
    assert cycle.K == K
    assert not cycle.stable
    case = naive.Naive(**STRIP.values, law="aging")
    # what a sinusoidal cycle of this amplitude would start with
    x, eta = float(cycle.amplitude) / 2 / STRIP.a, float(STRIP.eta(V_lp))
    stress = case.steady(V_lp)[0] + STRIP.a * x
    log_theta = np.log(STRIP.Dc / V_lp) + x / (2 + 2 * eta)
    t_max, lsoda = 3 * float(cycle.period), {"tol": 1e-12, "method": "LSODA"}
    found = naive.limit_cycle(case, stress, log_theta, V_lp, t_max, newtons=4, **lsoda)
    assert found.residual < 1e-8
    for name in ("amplitude", "period", "V_max", "V_min", "inertia"):
        assert getattr(found, name) == pytest.approx(float(cycle[name]), rel=2e-7), name
    jacobian = np.empty((2, 2))
    for i, d in enumerate((1e-4 * STRIP.a, 1e-4)):
        ends = []
        for sign in (1, -1):
            moved = found.end + sign * d * np.eye(2)[i]
            ends.append(naive.one_cycle(case, *moved, V_lp, t_max, **lsoda).end)
        jacobian[:, i] = (ends[0] - ends[1]) / (2 * d)
    multiplier = max(np.linalg.eigvals(jacobian).real)
    assert 1.005 < multiplier < 1.03
    assert multiplier == pytest.approx(float(cycle.multipliers[0].real), abs=1e-6)


def test_period_doublings():
    """A multiplier is -1; where it is beyond, limit_cycle finds a cycle of two returns."""
    branch = continue_cycle(WILD, "V_lp", 1e-2, 1e-3)
    assert specials(branch) == ["start", "period_doubling", "period_doubling", "hopf"]
    doublings = branch.isel(point=branch.special == "period_doubling")
    assert doublings.V_lp.values == pytest.approx([8.77521856e-3, 2.57637046e-3], rel=1e-7)
    for i, inward in enumerate((-1, 1)):
        assert doublings.multipliers[i, 0].values == pytest.approx(-1, abs=1e-6)
        V = float(doublings.V_lp[i])
        assert limit_cycle(WILD, V * (1 - 3e-3 * inward)).stable
        assert limit_cycle(WILD, V * (1 + 3e-3 * inward)).returns == 2
    between = (branch.V_lp < doublings.V_lp[0]) & (branch.V_lp > doublings.V_lp[1])
    assert between.sum() > 5
    first = branch.multipliers[:, 0]
    assert (first[between].real < -1).all()
    assert (np.abs(first[~between & (branch.special == "")]) < 1).all()
    assert not branch.stable[between].any()
    assert branch.stable[~between & (branch.special == "")].all()


BAD = {
    "parameter 'V0'": ((FIG2, "V0", 1e-3, 1e-2), {}, ["parameter = 'V0'", "one of V_lp, K"]),
    "list": ((FIG2, ["K"], 1e-3, 1e-2), {}, ["parameter = ['K']"]),
    "no slider": (({"a": 1}, "K", 1e-3, 1e-2), {}, ["slider", "SpringSlider"]),
    "no V_lp": ((FIG2, "K", 1e9, 1e8), {}, ["V_lp is missing", "at which K changes"]),
    "V_lp twice": ((FIG2, "V_lp", 1e-3, 1e-2), {"V_lp": 1e-3}, ["Leave V_lp= out"]),
    "start = stop": ((FIG2, "V_lp", "10 mm/s", 1e-2), {}, ["start = 0.01 equals stop"]),
    "start = 0": ((FIG2, "V_lp", 0, 1e-2), {}, ["start = 0 m/s"]),
    "start unit": ((FIG2, "K", "1 GPa", 1e8), {"V_lp": 1e-2}, ["start = '1 GPa' is a stress"]),
    "start array": ((FIG2, "V_lp", xr.DataArray([1e-3], dims="q"), 1), {}, ["start is an array"]),
    "sweep": (
        (FIG2.replace(M=xr.DataArray([1e2, 1e3], dims="M")), "V_lp", 1e-3, 1e-2),
        {},
        ["M is an array", "one slider"],
    ),
    "rtol small": ((FIG2, "V_lp", 1e-2, 1e-3), {"rtol": 9e-11}, ["rtol = 9e-11", "1e-10 to 1e-4"]),
    "b = a": ((FIG2.replace(b=0.003), "V_lp", 1e-2, 1e-3), {}, ["b <= a (b/a = 1)", "b > a"]),
    "b to a": ((FIG2, "b", 0.001, 0.003), {"V_lp": 1e-2}, ["b <= a"]),
    "b from < 0": ((FIG2, "b", -0.001, 0.006), {"V_lp": 1e-2}, ["start = -0.001", "0 < start"]),
    "M = 0": ((FIG2.replace(M=0), "V_lp", 1e-2, 1e-3), {}, ["M = 0", "a branch needs mass"]),
    "M to 0": ((FIG2, "M", 1e3, 0), {"V_lp": 1e-2}, ["stop = 0.0", "a branch needs mass"]),
    "K = inf": ((FIG2.replace(K=np.inf), "V_lp", 1e-2, 1e-3), {}, ["K = inf", "a spring"]),
    "K to inf": ((FIG2, "K", 1e9, np.inf), {"V_lp": 1e-2}, ["stop = inf", "0 < stop < inf"]),
    "steady throughout": (
        (FIG2, "V_lp", 1e-4, 1e-3),
        {},
        ["at start, V_lp = 0.0001", "no Hopf"],
    ),
    "b < a, then steady": ((FIG2, "a", 0.007, 0.0055), {"V_lp": 1e-3}, ["no Hopf point"]),
}


@pytest.mark.parametrize(("given", "settings", "parts"), BAD.values(), ids=BAD)
def test_bad_input(given, settings, parts):
    with pytest.raises(ParameterError) as caught:
        continue_cycle(*given, **settings)
    for part in parts:
        assert part in str(caught.value)


def test_a_branch_that_cannot_reach_stop_keeps_its_part(monkeypatch):
    """At Dc = 1e-19 m double precision ends; what was found comes along."""
    names = list(strip().data_vars)  # cached for other tests: with the steps as they are
    # shorter steps creep on through the rounding errors
    for name, length in (("FIRST", 0.12), ("SMALLEST", 0.03), ("LARGEST", 0.12)):
        monkeypatch.setattr(arclength, f"{name}_STEP", length)
    with pytest.raises(NotConverged, match=r"before it gets to 1e-30 \(no convergence\)") as caught:
        continue_cycle(FIG2, "Dc", 2e-19, 1e-30, V_lp=1e-2)
    best = caught.value.best
    assert specials(best) == ["start"]
    assert 1e-30 < float(best.Dc[-1]) < 2e-19
    assert best.Dc[0] == 2e-19
    assert f"Dc = {float(best.Dc[-1]):.6g}" in str(caught.value)
    assert list(best.data_vars) == names
    assert json.loads(best.attrs["scenario"])["V_lp"] == 1e-2


def test_no_single_cycle_at_start():
    with pytest.raises(NotConverged, match=r"at `start`.* 2 stress maxima \(period") as caught:
        continue_cycle(WILD, "V_lp", 5e-3, 1e-2)
    assert caught.value.best is None


@pytest.mark.parametrize("rtol", [1e-10, 1e-4])
def test_rtol_sets_the_accuracy_of_a_branch(rtol):
    branch = continue_cycle(STRIP, "V_lp", 4.6e-4, 1e-4, rtol=rtol)
    assert specials(branch) == ["start", "fold", "hopf"]
    fold = special(branch, "fold")
    assert float(fold.V_lp) == pytest.approx(FOLD, rel=max(10 * rtol, 3e-9))
    start = limit_cycle(STRIP, 4.6e-4, rtol=1e-11)
    for name in ("amplitude", "period"):
        off = float(branch[name][0] / start[name]) - 1
        assert abs(off) < 3 * rtol + 1e-10, name
        assert abs(off) < 2 * float(branch.error[0]), name
