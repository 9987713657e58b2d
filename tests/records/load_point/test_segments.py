"""The load point's history out of its displacement: known truth, noise, machines as they are."""

import re
from typing import NamedTuple

import numpy as np
import pytest
from scipy.signal import lfilter

from ratestate import ParameterError, find_segments
from ratestate.records.load_point import splits
from ratestate.records.load_point.segments import segments_from_displacement, segments_from_velocity

NOISE = 0.3e-6


def history(t, starts, V):
    """Displacement of a load point that has these speeds from these times on."""
    edges = np.array([*starts, max(t[-1], starts[-1]) + 1.0])
    return np.interp(t, edges, np.append(0.0, np.cumsum(np.asarray(V) * np.diff(edges))))


def drawn(rng):
    """Starts and speeds of a random history, times of its rows, and noise of a random kind."""
    V = [10 ** rng.uniform(-7, -3)]
    for _ in range(rng.integers(0, 7)):
        if V[-1] == 0.0:  # after a hold, as before it or otherwise
            V.append(V[-2] * (1.0 if rng.random() < 0.5 else 10 ** rng.uniform(-1, 1)))
        elif rng.random() < 0.25:
            V.append(0.0)
        else:
            ratio = 10 ** rng.uniform(np.log10(1.5), 3)
            step = V[-1] * ratio if V[-1] * ratio < 2e-3 else V[-1] / ratio
            V.append(max(step, 5e-8) if V[-1] > 7.5e-8 else 1.5 * V[-1])
    V = np.array(V)
    scatter = 10 ** rng.uniform(-8, -6.3)
    lasts = (10 ** rng.uniform(-4.5, -3, V.size) + 100 * scatter) / np.where(V > 0, V, 1)
    lasts[V == 0] = rng.uniform(0.2, 3) * np.median(lasts[V > 0])
    rows = 10 ** rng.uniform(1.7, 3.3, V.size)  # a rate of its own for each speed, or one for all
    dt = lasts / rows if rng.random() < 0.5 else np.full(V.size, lasts.min() / 15)
    if lasts.sum() / dt[0] > 3e4:
        dt = lasts / rows
    starts = np.append(0.0, np.cumsum(lasts))
    t = np.concatenate(
        [np.arange(a, b, d) for a, b, d in zip(starts, starts[1:], dt, strict=False)]
    )
    t = t[np.append(True, np.diff(t) > 1e-9 * t[-1])]
    rho = 0.0 if rng.random() < 0.5 else np.exp(-1 / 10 ** rng.uniform(0.3, 1.3))
    noise = lfilter([(1 - rho**2) ** 0.5], [1, -rho], rng.standard_normal(t.size))
    return starts[:-1], V, t, scatter * noise, rho


def test_random_histories():
    wrong, misses = 0, {True: [], False: []}
    for seed in range(100):
        starts, V, t, noise, rho = drawn(np.random.default_rng(seed))
        found = segments_from_displacement(t + 1e4, 8e-3 + history(t, starts, V) + noise)
        assert found.t[0] == 1e4
        if found.V.size != V.size:
            wrong += 1
            continue
        wrong += ((found.V == 0) != (V == 0)).any()
        misses[rho == 0.0] += ((found.t[1:] - 1e4 - starts[1:]) / found.t_error[1:]).tolist()
    assert wrong <= 3  # seen: 1
    white, correlated = (np.array(misses[key]) for key in (True, False))
    assert min(white.size, correlated.size) > 100
    assert 0.9 < white.std() < 1.15
    assert 0.9 < correlated.std() < 1.35
    assert max(abs(white).max(), abs(correlated).max()) < 6.0


def test_without_noise_breaks_come_out_to_rounding():
    for seed in range(25):
        starts, V, t, _, _ = drawn(np.random.default_rng(seed))
        found_t, found_V = find_segments(t, history(t, starts, V))
        assert found_V.size == V.size, seed
        np.testing.assert_allclose(found_t, starts, rtol=0, atol=2e-14 * t[-1])
        np.testing.assert_allclose(found_V, V, rtol=0, atol=1e-14 * V.max())
        np.testing.assert_array_equal(found_V == 0.0, V == 0.0)


@pytest.mark.parametrize("V", [(2e-7, 2e-6), (3e-6, 1e-5), (1e-5, 1e-6), (1e-5, 0.0), (1e-5, 1e-3)])
def test_a_break_is_found_as_exactly_as_noise_allows(V):
    # Two lines through n rows each, s the noise: each is known at its end to 4 s^2 / n, and they
    # cross at a time known to 4 s^2 (1/n + 1/m) / (V_1 - V_2)^2 (a level, where V = 0, to s^2 / m)
    rng = np.random.default_rng(0)
    before, after = 400, 600
    dt = 40 * NOISE / max(V) / 20
    t = (np.arange(before + after) + 0.5) * dt
    x = history(t, [0, before * dt], V)
    limit = NOISE / abs(V[0] - V[1]) * (4 / before + (4 if V[1] else 1) / after) ** 0.5
    found = [
        segments_from_displacement(t, x + NOISE * rng.standard_normal(t.size)) for _ in range(120)
    ]
    assert {f.V.size for f in found} == {2}
    times = np.array([f.t[1] for f in found])
    assert abs(times.mean() - before * dt) < 4 * limit / 120**0.5
    assert 0.8 < times.std() / limit < 1.2  # 120 draws know it to 6.5 %
    stated = np.median([f.t_error[1] for f in found])
    assert 0.9 < stated / limit < 1.2
    if not V[1]:
        assert {f.V[1] for f in found} == {0.0}


class Case(NamedTuple):
    """Rows of a displacement, its segments and what is noted of it; None: whatever that is."""

    t: np.ndarray
    x: np.ndarray
    V: tuple
    starts: tuple = (0.0,)
    rtol: float = 0.01
    within: float = 0.05  # of starts [s]
    t_error: float | None = None  # of the last start [s]
    notes: tuple | None = ()


def white(size, seed, t):
    return size * np.random.default_rng(seed).standard_normal(t.size)


DT_GAP, GAP = 0.1, 600  # s between rows, and rows that are lost
MINUTE, FIVE, THREE = np.arange(600) * 0.1, np.arange(3000) * 0.1, np.arange(10_000) * 0.02
GAPPED = np.append(DT_GAP * np.arange(600), DT_GAP * (600 + GAP + np.arange(600)))
TWO, UP = (1e-6, 1e-5), (3e-6, 1e-5)


def wandering():
    """A tenth of a turn of a gear, and drifts of a tenth of a micron: a change of speed by 3 %."""
    t = np.arange(0, 600, 0.05)
    x = history(t, [0, 300], TWO)
    wander = 2e-7 * np.sin(2 * np.pi * x / 100e-6) + 1e-7 * np.sin(2 * np.pi * t / 170)
    return t, x + wander + white(5e-8, 3, t)


def cases():
    for V in (1e-7, 1e-5, 0.0):
        yield f"one speed, {V}", Case(FIVE, V * FIVE + white(NOISE, 1, FIVE), (V,))
    yield "a machine that wanders", Case(*wandering(), TWO, (0, 300), notes=None)
    x = 1e-5 * FIVE + 1e-6 * np.sin(FIVE / 5) + white(5e-10, 3, FIVE)
    yield "and more", Case(FIVE, x, None, notes=("wanders about constant speeds",))
    x = history(THREE, [0, 100], UP) + 1e-6 * (THREE >= 104) + 1e-6 * (THREE >= 40)
    notes = " at 40 s", "as in 0.1 s at that speed"
    yield "jumps", Case(THREE, x + white(1.5e-7, 4, THREE), UP, (0, 100), 0.002, notes=notes)
    x = history(FIVE, [0, 100, 200], [1e-5, 0, 1e-5]) - 2e-8 * np.clip(FIVE - 100, 0, 100)
    notes = ("runs back by 2 um in the hold at 100",)
    V, starts = (1e-5, 0.0, 1e-5), (0, 100, 200)
    yield (
        "a hold that gives",
        Case(FIVE, x + white(5e-8, 6, FIVE), V, starts, within=0.15, notes=notes),
    )
    x = history(FIVE, [0, 1], [2e-8, 1e-5]) + white(5e-8, 6, FIVE)
    notes = ("cannot be distinguished from a speed of up to",)
    yield "a short hold", Case(FIVE, x, (0.0, 1e-5), (0, 1), within=0.1, notes=notes)
    # a sensor that sticks gives a hold that was none, which ends with a jump
    x = history(MINUTE, [0, 20, 25], [1e-5, 0, 1e-5])
    yield "a hold", Case(MINUTE, x, V, (0, 20, 25), within=0.1)
    stuck = x + 50e-6 * (MINUTE >= 25)
    notes = ("jumps by 49 um at 25 s",)
    yield "a sensor that sticks", Case(MINUTE, stuck, V, (0, 20, 25), within=0.1, notes=notes)
    for jump in (-100e-6, -30e-6, 30e-6):  # a sensor that is set to zero when the speed changes
        for noise in (0.0, 0.2e-6):
            x = history(MINUTE, [0, 29.95], TWO) + jump * (MINUTE > 29.95)
            error, notes = 0.1 / 12**0.5, ("its speed changes there as well",)
            case = Case(MINUTE, x + white(noise, 2, MINUTE), TWO, (0, 29.95), 0.01, 0.051, error)
            yield f"a jump of {jump} at a step, {noise}", case._replace(notes=notes)
    for moved in (0.0, 1.0, 3.0):  # in a gap: nothing, as before, or three times as far
        for noise in (1e-9, 5e-8):
            t = GAPPED
            x = np.where(t < 60, t, t + (moved - 1) * (60 + DT_GAP)) * 1e-6 + white(noise, 4, t)
            notes = ("jumps",) if moved != 1.0 else ()
            yield f"a gap, {moved}, {noise}", Case(t, x, (1e-6,), rtol=1e-3, notes=notes)
    for V in (1e-5, 0.0):  # a step where the speeds meet: at a gap's beginning, inside, at its end
        for where in (0.0, 0.3, 1.0):
            step, t = 59.9 + where * DT_GAP * (GAP + 1), GAPPED
            x = np.where(t < step, 1e-6 * t, 1e-6 * step + V * (t - step)) + white(1e-9, 5, t)
            yield f"a step in a gap, {V}, {where}", Case(t, x, (1e-6, V), (0, step), 1e-4, 2e-3)
    for moved in (0.0, 100.0):  # the load point stood still for a time, or was moved
        x = np.where(t < 60, 1e-6 * t, 59.9e-6 + moved * 60.1e-6 + 1e-5 * (t - 120))
        error, notes = 60.1 / 12**0.5, ("changes in the gap in time from 59.9 s to 120 s",)
        case = Case(t, x + white(1e-9, 6, t), TWO, (0, 89.95), 1e-4, 1e-6, error)
        yield f"open in a gap, {moved}", case._replace(notes=notes)


CASES = dict(cases())


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_records_as_machines_make_them(case):
    found = segments_from_displacement(case.t, case.x)
    if case.V is not None:
        np.testing.assert_allclose(found.V, case.V, rtol=case.rtol)
        np.testing.assert_allclose(found.t, case.starts, rtol=0, atol=case.within)
    if case.t_error is not None:
        assert found.t_error[-1] == pytest.approx(case.t_error, rel=0.01)
    if case.notes is not None:
        for words in case.notes:
            assert any(words in note for note in found.notes), found.notes
        assert bool(case.notes) == bool(found.notes), found.notes


@pytest.mark.parametrize(("intervals", "segments"), [(1, 2), (2, 2), (5, 4)])
def test_a_jump_may_leave_a_row_within_it(intervals, segments):
    """A recorder that averages has a row or two between; more are a brief speed, and no jump."""
    t, rng = np.arange(600) * 0.1, np.random.default_rng(8)
    jump = 0.9e-6 * np.clip((np.arange(600) - 303.5) / intervals, 0.0, 1.0)
    x = history(t, [0, 50], [3e-6, 1e-5]) + jump + 2.5e-8 * rng.standard_normal(t.size)
    found = segments_from_displacement(t, x)
    assert found.V.size == segments
    np.testing.assert_allclose(found.V[[0, -1]], [3e-6, 1e-5], rtol=2e-3)
    assert ["delta_lp jumps by" in note for note in found.notes] == [True] * (segments == 2)


def test_a_jump_beside_a_gap_is_not_taken_for_the_step_within_the_gap():
    t, rng = np.arange(2000) * 0.1, np.random.default_rng(8)
    x = history(t, [0, 129.9], [1e-5, 3e-6]) + 1e-8 * rng.standard_normal(t.size)
    x[t >= 127.8] += 2.4e-6
    kept = (t < 128.7) | (t > 130.8)
    found = segments_from_displacement(t[kept], x[kept])
    assert found.V.size == 2
    assert abs(found.t[1] - 129.9) < min(4.0 * found.t_error[1], 0.01)
    assert any("delta_lp jumps by" in note for note in found.notes)


def test_a_short_ramp_of_speed_is_found_as_a_step():
    t = np.arange(0, 100, 0.01)
    V = np.interp(t, [0, 50, 50.4, 100], [1e-6, 1e-6, 1e-3, 1e-3])
    noise = NOISE * np.random.default_rng(5).standard_normal(t.size)
    found = segments_from_displacement(
        t, np.append(0, np.cumsum(0.01 * 0.5 * (V[1:] + V[:-1]))) + noise
    )
    np.testing.assert_allclose(found.V, [1e-6, 1e-3], rtol=0.01)
    assert abs(found.t[1] - 50.2) < 0.01  # in the middle of the ramp: the same displacement after
    assert len(found.notes) == 1
    assert re.search(
        r"changes over about 0.[34]\d? s from 50.0\d* s on, which is taken", found.notes[0]
    )


def driven(seed, ramp):
    """Times, recorded speed and displacement of a motor that needs this long to change its speed.

    It slides at 3 um/s, holds for 10 s from 60.2 s on, slides, and slides faster from 130.2 s on.
    """
    rng = np.random.default_rng(seed)
    t = np.arange(0.1 * rng.random(), 170.0, 0.1)
    edges = np.array([0, 60.2, 60.2, 70.2, 70.2, 130.2, 130.2, 170])
    edges[1:-1] += np.tile([-0.5, 0.5], 3) * ramp
    speeds = np.array([3, 3, 0, 0, 3, 3, 30, 30]) * 1e-6
    V = np.interp(t, edges, speeds)
    fine = np.linspace(0.0, 170.0, 170_001)
    x = np.interp(
        t, fine, np.append(0, np.cumsum(np.interp(fine[1:] - 5e-4, edges, speeds)) * 1e-3)
    )
    return t, V * (1 + 0.003 * rng.standard_normal(t.size)), x + white(3e-9, seed, t)


@pytest.mark.parametrize("ramp", [0.4, 0.7])
@pytest.mark.parametrize("seed", range(7))
def test_a_ramp_beside_a_brief_hold_is_a_step(ramp, seed):
    t, V, x = driven(seed, ramp)
    for found in (segments_from_velocity(t, V), segments_from_displacement(t, x)):
        np.testing.assert_allclose(found.V, [3e-6, 0, 3e-6, 3e-5], rtol=2e-3)
        np.testing.assert_allclose(found.t[1:], [60.2, 70.2, 130.2], atol=0.015)
        assert max(abs(found.t[1:] - [60.2, 70.2, 130.2]) / found.t_error[1:]) < 5.0
        assert ["is taken as a step" in note for note in found.notes] == [True] * 3


def test_a_slow_ramp_is_not_a_step():
    """It lasts a tenth of the hold and displaces 4 um, or a third of the hold."""
    t, V, x = driven(0, 4.0)
    for found in (segments_from_velocity(t, V), segments_from_displacement(t, x)):
        assert found.V.size > 7


def test_louder_noise_in_a_part_of_the_record_makes_no_steps():
    t, rng = np.arange(0, 600, 0.1), np.random.default_rng(1)
    noise = 1e-7 * rng.standard_normal(t.size) * np.where((t > 250) & (t < 320), 10.0, 1.0)
    found = segments_from_displacement(t, history(t, [0, 200, 400], [1e-6, 1e-5, 1e-6]) + noise)
    np.testing.assert_allclose(found.t, [0, 200, 400], atol=0.1)


def rounded_hold(seed, V, noise, digit=1e-7):
    """Segments of a slide, a hold and a slide, rounded after noise [digits] is added."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.03, 220, 0.1)
    x = history(t, [0, 60, 160], [V, 0.0, V]) + digit * (
        rng.random() + noise * rng.normal(size=2200)
    )
    return segments_from_displacement(t, digit * np.round(x / digit))


@pytest.mark.parametrize("noise", [0.1, 0.2])
@pytest.mark.parametrize(("V", "digit"), [(1e-6, 1e-7), (1.3e-6, 1e-7), (2e-6, 1e-7), (1e-6, 5e-7)])
def test_a_hold_in_few_digits(V, digit, noise):
    """Rows that alternate between two digits are not steps; means keep the rounding."""
    misses = []
    for seed in range(10):
        found = rounded_hold(seed, V, noise, digit)
        np.testing.assert_allclose(found.V, [V, 0.0, V], rtol=1e-3)
        misses += ((found.t[1:] - [60, 160]) / found.t_error[1:]).tolist()
    assert 0.2 < np.std(misses) < 1.6
    assert max(np.abs(misses)) < 5.0


def test_noise_of_a_digit_averages_the_rounding():
    """A line through n rows is known at its end to 4 s^2 / n, and the hold to s^2 / n."""
    limit = 1e-7 * np.sqrt(13 / 12 * (4 / 600 + 1 / 1000)) / 1e-6
    for seed in range(5):
        assert rounded_hold(seed, 1e-6, 1.0).t_error[1:] == pytest.approx([limit] * 2, rel=0.25)


def test_levels_of_a_recorded_velocity():
    t = np.arange(0, 100, 0.1)
    V = np.select([t < 30.05, t < 60.05], [1e-6, 0.0], 1e-5)
    found = segments_from_velocity(t, V)
    np.testing.assert_allclose(found.t, [0, 30.05, 60.05], rtol=1e-12)
    np.testing.assert_allclose(found.V, [1e-6, 0, 1e-5], rtol=1e-12, atol=0)
    rng = np.random.default_rng(7)
    many = [segments_from_velocity(t, V + 1e-6 * rng.standard_normal(t.size)) for _ in range(50)]
    assert {f.V.size for f in many} == {3}
    misses = [(f.t[1] - 30.05) / f.t_error[1] for f in many]
    assert 0.4 < np.std(misses) < 1.6
    assert max(abs(f.t[2] - 60.05) for f in many) < 0.01


def test_columns_that_are_not_a_history_are_refused():
    t = np.arange(100.0)
    for times, x, match in [
        (t, t[1:], "two columns of equal length"),
        (t[:3], t[:3], "at least 4 rows"),
        (t[::-1], t, "t does not increase at index 1"),
        (t, np.where(t == 3, np.nan, t), "not finite"),
        (t, ["1 um"] * 100, "Give numbers in SI"),
        (
            t,
            np.where(t < 50, t, 100 - t) * 1e-6,
            r"backwards, at 1 um/s from 50 s.*None, '",
        ),
        (t, np.where(t < 50, 50 - t, t - 50) * 1e-6, r"backwards.* time=\('49 s', None\)"),
    ]:
        with pytest.raises(ParameterError, match=match):
            find_segments(times, x)
    with pytest.raises(ParameterError, match="V_load is -1 um/s from 50 s on"):
        segments_from_velocity(t, np.where(t < 50, 1e-6, -1e-6))


def test_a_record_without_constant_speeds_is_refused(monkeypatch):
    monkeypatch.setattr(splits, "MAX_RUNS", 20)
    t = np.arange(8000.0)
    x = 1e-6 * np.cumsum(1.5 + np.sign(np.sin(np.pi * t / 200 + 0.1)))
    with pytest.raises(
        ParameterError, match="no constant speeds from 0 s to 7999 s: they would need more than 20"
    ):
        find_segments(t, x)
    monkeypatch.undo()
    assert find_segments(t, x)[1].size == 41


@pytest.mark.parametrize(("moved", "still"), [(1.0, True), (2.2, False)])
def test_a_hold_may_move_by_the_noise(moved, still):
    """1.5 times its standard deviation: far more than the error of so long a hold's speed."""
    t = np.arange(0, 300, 0.1)
    noise = NOISE * np.random.default_rng(8).standard_normal(t.size)
    hold = (t >= 100) & (t < 200)
    noise[hold] -= np.polyval(np.polyfit(t[hold], noise[hold], 1), t[hold])
    found = segments_from_displacement(
        t, history(t, [0, 100, 200], [1e-5, moved * NOISE / 100, 1e-5]) + noise
    )
    assert found.V.size == 3
    assert (found.V[1] == 0.0) == still


def averaging_recorder(seed, first, then, steps, noises, correlation=0.0, digit=0.0):
    """Times and displacement of a record at two rates, each with noise of its own.

    first, then : (start, end, interval) [s]; steps : (time, speed) [m/s]; noises [m], of which
    the first may be correlated from row to row, and displacement rounded to a digit [m]
    """
    rng = np.random.default_rng(seed)
    parts = [np.arange(*first), np.arange(*then)]
    white = [rng.standard_normal(part.size) for part in parts]
    white[0] = lfilter([(1 - correlation**2) ** 0.5], [1, -correlation], white[0])
    t = np.concatenate(parts)
    x = history(t, *np.transpose(steps)) + np.repeat(noises, [p.size for p in parts]) * (
        np.concatenate(white)
    )
    return t, np.round(x / digit) * digit if digit else x


SLOWER = ((0, 250, 0.1), (250, 262, 0.01), [(0, 2.29e-6), (252, 22.9e-6)])
FASTER = ((0, 2, 0.001), (2, 262, 0.1), [(0, 229e-6), (1.99, 2.29e-6)])


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize(
    ("parts", "noises", "other"),
    [
        (SLOWER, (0.07e-6, 0.42e-6), {}),
        (SLOWER, (0.02e-6, 0.8e-6), {}),
        (SLOWER, (0.5e-6, 0.05e-6), {}),
        (FASTER, (0.8e-6, 0.2e-6), {"correlation": 0.65, "digit": 0.0765e-6}),
        (FASTER, (0.8e-6, 0.02e-6), {"correlation": 0.8}),
    ],
)
def test_noise_that_differs_with_the_sampling_rate(seed, parts, noises, other):
    """Neither holds of milliseconds nor steps in the noise, whatever the window."""
    *times, steps = parts
    t, x = averaging_recorder(seed, *times, steps, noises, **other)
    for cut in (0.0, 0.13, 0.7):
        rows = t >= cut
        found = segments_from_displacement(t[rows], x[rows])
        np.testing.assert_allclose(found.V, [V for _, V in steps], rtol=0.01)
        assert abs(found.t[1] - steps[1][0]) < 5.0 * found.t_error[1]
        assert 1e-4 < found.t_error[1] < 0.01


def test_errors_come_from_the_noise_of_their_own_rate():
    """Of a speed at 10 Hz and 0.07 um, then at 100 Hz and 0.42 um: by least squares."""
    scaled = []
    for seed in range(50):
        t, x = averaging_recorder(100 + seed, *SLOWER, (0.07e-6, 0.42e-6))
        found = segments_from_displacement(t, x)
        scaled.append((found.V - [2.29e-6, 22.9e-6]) / found.V_error)
    assert (np.abs(np.std(scaled, axis=0) - 1.0) < 0.25).all()
    slow = 0.07e-6 / np.sqrt(2500 * 250.0**2 / 12.0)
    assert found.V_error[0] == pytest.approx(slow, rel=0.15)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("speed", [0.0, 1e-6])
def test_a_constant_speed_without_noise(speed):
    """As in a window of a simulated run: no division by the noise of 0."""
    found = segments_from_velocity(np.arange(0.0, 50.0, 0.2), np.full(250, speed))
    assert found.V.tolist() == [speed]
