"""Fits of each step and hold of an experiment."""

import itertools
import re
import warnings

import numpy as np
import pytest
import xarray
from scipy.stats import ttest_ind
from synthetic_experiments import experiment

import ratestate as rs
from ratestate.records.fitting import inference
from ratestate.records.fitting.settings import checked_settings
from ratestate.records.fitting.steps import experiment as fits
from ratestate.records.fitting.steps import shared
from ratestate.records.fitting.steps.shared import estimates_of, mean_of, ratio_of, shared_fit
from ratestate.records.fitting.steps.windows import stick_slip_segments, windows_of
from ratestate.report.steps import table_of

pytestmark = pytest.mark.usefixtures("in_one_process")
SLIDER = rs.SpringSlider(a=0.009, b=0.012, Dc="20 um", sigma="8 MPa", K="6 GPa/m")
START = SLIDER.replace(a=0.005, b=0.005, Dc="30 um")
NOISE = {"noise": 1.5e-4, "red": 1e-4, "time": 3.0}
FAST, SLOW = 1e-5, 3e-6
SPEEDS = (SLOW, FAST, SLOW, (0.0, 300.0), SLOW, FAST)
MANY = (SLOW, FAST) * 3 + (SLOW,)
FREE = ["a", "b", "Dc", "K"]
ROWS = 300  # at each speed


@pytest.fixture(scope="module")
def data():
    return experiment(SLIDER, SPEEDS, 500e-6, ROWS, drift=10.0, seed=4, **NOISE)


@pytest.fixture(scope="module")
def under_both(data):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rs.FitWarning)
        return rs.fit(data, START, law=("slip", "aging"), per_step=True, errors="covariance")


@pytest.fixture(scope="module")
def under_slip(data):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return rs.fit(data, START, per_step=True)


def test_variables_on_the_load_point(under_slip):
    assert under_slip.kind.values.tolist() == ["step", "step", "hold", "step"]
    assert under_slip.step.values.tolist() == [1, 2, 3, 4]
    starts = 500.0 / 3.0 + np.array([0.0, 50.0, 50.0 + 500.0 / 3.0, 350.0 + 1000.0 / 3.0])
    np.testing.assert_allclose(under_slip.step_t, starts, atol=1e-3)
    moved = 500e-6 * np.array([1.0, 2.0, 3.0, 4.0])
    np.testing.assert_allclose(under_slip.step_delta_lp, moved, rtol=1e-6)
    np.testing.assert_allclose(under_slip.V_before, [SLOW, FAST, SLOW, SLOW], rtol=1e-6)
    np.testing.assert_allclose(under_slip.V_after, [FAST, SLOW, SLOW, FAST], rtol=1e-6)
    np.testing.assert_allclose(under_slip.t_hold, [np.nan, np.nan, 300.0, np.nan], rtol=1e-5)
    assert (under_slip.sigma == SLIDER.sigma).all()
    assert (under_slip.status == 0).all()
    assert set(under_slip.a.dims) == {"step"}


def test_estimates_agree_with_the_truth_within_their_errors(under_slip):
    truth = np.array([getattr(SLIDER, name) for name in FREE])
    estimates = np.array([under_slip[name].values for name in FREE]).T
    deviation = (estimates - truth) / under_slip.standard_error.sel(parameter=FREE).values
    assert np.abs(deviation).max() < 3.5
    assert 0.4 < np.sqrt(np.mean(deviation**2)) < 1.7
    assert (under_slip.standard_error.sel(parameter="Dc") < 2e-6).all()


def test_a_step_is_fitted_as_its_window_alone(data, under_slip):
    """The initial guesses differ, and so do the last digits."""
    window = windows_of(data)[1]
    alone = rs.fit(window.part(data), START)
    one = under_slip.isel(step=1)
    assert int(one.samples) == alone.sizes["time"]
    for name in (*FREE, "mu0", "trend_slip", "rms", "aic"):
        assert float(one[name]) == pytest.approx(float(alone[name]), rel=1e-3), name
    np.testing.assert_allclose(
        one.interval.sel(parameter=FREE), alone.interval.sel(parameter=FREE), rtol=2e-2
    )
    kept = np.isfinite(one.time.values)
    shown = alone.sel(time=one.time.values[kept])
    np.testing.assert_allclose(one.friction[kept], shown.friction, rtol=1e-12)
    np.testing.assert_allclose(one.friction_fit[kept], shown.friction_fit, atol=2e-5)


def test_both_laws_side_by_side(under_both, under_slip):
    assert under_both.Dc.dims == ("step", "law")
    slip = under_both.sel(law="slip")
    np.testing.assert_allclose(slip.Dc, under_slip.Dc, rtol=1e-3)
    assert (under_both.aic_difference.sel(law="slip") == 0.0).sum() >= 3
    assert under_both.aic_difference.sel(law="aging").sum() > 30.0
    np.testing.assert_allclose(under_both.akaike_weight.sum("law"), 1.0)
    assert "The slip law fits clearly better" in under_both.comparison


def test_one_set_serves_all_steps_under_the_right_law_alone(under_both):
    p = under_both.shared_p_value
    assert 1e-3 < float(p.sel(law="slip")) < 1.0
    assert float(p.sel(law="aging")) < 1e-6
    assert (under_both.shared_degrees == 9).all()  # a, b and Dc of four steps
    shared = under_both.shared.sel(law="slip")
    error = under_both.shared_error.sel(law="slip")
    for name in ("a", "b", "Dc"):
        off = float(shared.sel(parameter=name)) - getattr(SLIDER, name)
        own = float(error.sel(parameter=name))
        assert abs(off) < 3.5 * own, name
        each = under_both.standard_error.sel(law="slip", parameter=name)
        assert own < float(each.min()), name
    assert np.isnan(shared.sel(parameter="K"))  # a parameter of the machine is not shared


def test_healing_is_predicted_by_the_joint_fit(data, under_both):
    """Errors of the joint fit, and the error of K from one step, are propagated."""
    law = "slip"
    slider, joint = rs.fitted_slider(under_both, law), under_both.sel(law=law, parameter=FREE)

    def healed(**changes):
        result = rs.healing(data, slider=slider.replace(**changes))
        return float(result.delta_mu_predicted[0, 0])

    predicted = rs.healing(data, slider=under_both).sel(law=law)
    assert float(predicted.delta_mu_predicted[0]) == pytest.approx(healed(), rel=1e-9)
    spacing = {name: 1e-3 * getattr(slider, name) for name in FREE}
    slopes = [
        (healed(**{name: getattr(slider, name) + h}) - healed(**{name: getattr(slider, name) - h}))
        / (2.0 * h)
        for name, h in spacing.items()
    ]
    correlation = joint.shared_correlation.sel(other=FREE).values
    np.testing.assert_allclose(np.diag(correlation)[:3], 1.0)
    correlation[3] = correlation[:, 3] = [0.0, 0.0, 0.0, 1.0]
    errors = joint.shared_error.values
    errors[3] = np.hypot(float(joint.standard_error[:, 3].median()), float(joint.scatter[3]))
    changes = slopes * errors
    expected = float(np.sqrt(changes @ correlation @ changes))
    assert float(predicted.delta_mu_predicted_error[0]) == pytest.approx(expected, rel=0.01)
    assert not 0.9 < expected / np.linalg.norm(changes) < 1.1  # the correlation counts


def test_healing_of_steps_without_a_joint_fit_is_refused(data, under_both):
    lacking = under_both.copy(deep=True)
    lacking.shared.loc[{"law": "aging"}] = np.nan
    lacking.shared_error.loc[{"law": "aging"}] = np.nan
    with pytest.raises(rs.ParameterError, match="no joint fit under the aging law"):
        rs.healing(data, slider=lacking)


def sawtooth(data, teeth, begin, end=np.inf):
    """Return the record with stress drops of 0.05 in friction between two times."""
    t = data.time.values
    inside = (t >= begin) & (t < end)
    phase = (t[inside] - begin) / (min(end, t[-1]) - begin)
    friction = data.friction.values.copy()
    friction[inside] += 0.05 * ((teeth * phase) % 1.0)
    return data.assign(friction=("time", friction))


def test_steps_in_stick_slip_are_not_fitted(data, under_slip):
    begin = float(under_slip.step_t[3])
    with pytest.warns(rs.FitWarning, match=r"1 of 4 are stick-slip, and are not fitted \(step 4"):
        result = rs.fit(sawtooth(data, 6, begin), START, per_step=True, errors="covariance")
    assert result.status.values.tolist() == [0, 0, 0, 2]
    assert result.status.flag_meanings == "fitted failed stick_slip"
    message = str(result.message[3].item())
    for words in ("6 stick-slip events at 10 um/s", "ratestate events", "--against cycles"):
        assert words in message
    for name in FREE:
        np.testing.assert_allclose(result[name][:3], under_slip[name][:3], rtol=1e-3)
        assert np.isnan(result[name][3])
    text = " ".join(str(rs.summary(result)).split())
    assert text.count("step 4: not fitted") == 1
    assert "failed" not in text
    assert "stick-slip" in next(row for row in table_of(result, "slip").rows if row[0] == "4")


def test_a_record_of_stick_slip_alone_is_refused(data, under_slip):
    times = [float(data.time[0]), *under_slip.step_t.values, np.inf]
    for begin, end in itertools.pairwise(times):
        data = sawtooth(data, 6, begin, end)
    words = r"each of the 4 steps and holds \(.* events at .*ratestate events.*against='cycles'"
    with pytest.raises(rs.ParameterError, match=words):
        rs.fit(data, START, per_step=True)


def test_few_or_small_drops_are_not_stick_slip(data, under_slip):
    begin = float(under_slip.step_t[3])
    found = [len(stick_slip_segments(sawtooth(data, n, begin), SLIDER.sigma)) for n in (3, 4)]
    assert found == [0, 1]
    part = sawtooth(data, 8, begin)
    drifts = 0.05 * np.where(data.time > begin, data.time - begin, 0.0) / 50.0
    for times, count in ((1.0, 1), (4.0, 0)):
        one = part.assign(friction=part.friction + times * drifts)
        assert len(stick_slip_segments(one, SLIDER.sigma)) == count


def test_the_joint_fit_uses_only_converged_fits(data, monkeypatch):
    settings = checked_settings(
        START,
        free=FREE,
        law=None,
        noise=None,
        against="time",
        trend="slip",
        start="auto",
        errors="auto",
    )
    steps = fits.fit_each(fits.steps_of(data, settings))
    joint = shared_fit(steps)
    assert joint.degrees == 9

    def changed(step, **values):
        return step._replace(solution=step.solution._replace(**values))

    def runs_away(step):
        point = step.solution.point.copy()
        point[step.solution.unknowns.names.index("b")] *= 3.0
        return changed(step, point=point)

    wild = [*map(runs_away, steps[:3]), steps[3]]  # with medians of these no step moves
    assert shared_fit(wild).point == pytest.approx(joint.point, rel=1e-5)

    some = [changed(steps[0], converged=False), *steps[1:]]
    assert shared_fit(some).degrees == 6
    assert np.isfinite(estimates_of(some, "Dc")).all(axis=0).tolist() == [False, True, True, True]
    one_left = [*(changed(step, converged=False) for step in steps[:3]), steps[3]]
    assert shared_fit(one_left) is None
    monkeypatch.setattr(shared, "MOST", 1)
    assert shared_fit(steps) is None


@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
def test_steps_up_and_down_are_alike_under_the_right_law_alone():
    """For steps of the slip law, the aging law gives a shorter Dc up than down."""
    many = experiment(SLIDER, MANY, 400e-6, 200, seed=6, **NOISE)
    result = rs.fit(many, START, law=("slip", "aging"), per_step=True, errors="covariance")
    ratio = result.up_over_down.sel(parameter="Dc")
    error = result.up_over_down_error.sel(parameter="Dc")
    p = result.up_over_down_p_value.sel(parameter="Dc")
    assert abs(float(ratio.sel(law="slip")) - 1.0) < 4.0 * float(error.sel(law="slip"))
    assert 0.4 < float(ratio.sel(law="aging")) < 0.75
    assert float(p.sel(law="slip")) > 0.01
    assert float(p.sel(law="aging")) < 1e-3
    text = str(rs.summary(result))
    assert "slip law: steps up and steps down are alike: Dc of steps up is" in text
    assert "aging law: steps up and steps down are not alike" in text


def test_ratio_of_steps_up_and_down():
    """Compare with Student's test of SciPy, for errors much smaller than the scatter."""
    rng = np.random.default_rng(4)
    up, down = rng.normal(0.1, 0.2, 7), rng.normal(0.0, 0.2, 5)
    ratio, _, p_value = ratio_of((up, np.full(7, 1e-3)), (down, np.full(5, 1e-3)), True)
    expected = ttest_ind(up, down)
    assert ratio == pytest.approx(np.exp(up.mean() - down.mean()))
    assert p_value == pytest.approx(expected.pvalue, rel=1e-6)
    # with one step in each group the scatter is unknown
    alone = ratio_of(np.array([[0.2], [0.01]]), np.array([[0.1], [0.01]]), True)
    assert alone[0] == pytest.approx(np.exp(0.1))
    assert np.isnan(alone[1:]).all()
    # if errors are larger than the scatter, the error follows from them
    ratio, error, _ = ratio_of((up, np.full(7, 0.5)), (down, np.full(5, 0.5)), True)
    assert error == pytest.approx(ratio * 0.5 * np.sqrt(1 / 7 + 1 / 5))


def test_a_step_that_fails_leaves_the_others(data, under_slip):
    bad = data.copy(deep=True)
    bad.friction.values[3 * ROWS + 50] = np.nan
    with pytest.warns(rs.FitWarning, match=r"1 of 4 cannot be fitted \(step 3; see message\)"):
        result = rs.fit(bad, START, per_step=True, errors="covariance")
    assert result.status.values.tolist() == [0, 0, 1, 0]
    assert result.status.flag_meanings == "fitted failed stick_slip"
    assert "friction is nan in row" in str(result.message[2].item())
    assert (result.message[[0, 1, 3]] == "").all()
    for name in (*FREE, "mu0", "rms", "aic"):
        assert np.isnan(result[name][2]), name
        np.testing.assert_allclose(result[name][[0, 1, 3]], under_slip[name][[0, 1, 3]], rtol=1e-3)
    assert np.isnan(result.interval[2]).all()
    assert "step 3, slip law, failed: friction is nan" in str(rs.summary(result))


@pytest.mark.parametrize("law", ["slip", ("slip", "aging")])
def test_a_step_without_a_posterior_has_a_warning(law, monkeypatch):
    def no_posterior(*_):
        raise rs.SolverError("no sample is likely.")

    monkeypatch.setattr(inference, "sample_posterior", no_posterior)
    data = experiment(SLIDER, (SLOW, FAST), 500e-6, ROWS, seed=2, **NOISE)
    with pytest.warns(rs.FitWarning) as emitted:
        result = rs.fit(data, START, ("a",), law, per_step=True, errors="posterior")
    said = "step 1, slip law: the posterior failed, .* The reason: no sample is likely."
    assert re.match(said, str(emitted[0].message))
    assert emitted[0].filename == __file__
    assert "the posterior failed" in str(result.warnings.values.flat[0])
    assert (result.status == 0).all()
    assert set(result.interval_kind.values.flat) <= {"covariance", "profile", ""}


@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
def test_many_rows_are_averaged(monkeypatch):
    data = experiment(SLIDER, (SLOW, FAST), 500e-6, 2000, seed=2, **NOISE)
    (whole,) = rs.fit(data, START, per_step=True, errors="covariance").groupby("step")
    monkeypatch.setattr(fits, "MOST", 400)
    (fewer,) = rs.fit(data, START, per_step=True, errors="covariance").groupby("step")
    whole, fewer = whole[1].squeeze(), fewer[1].squeeze()
    # a window begins at a row, and the step is just after a row
    assert (int(whole.samples), int(whole.rows_per_sample)) == (2999, 1)
    assert (int(fewer.samples), int(fewer.rows_per_sample)) == (374, 8)
    for name in FREE:
        error = float(whole.standard_error.sel(parameter=name))
        assert abs(float(whole[name] - fewer[name])) < 2.0 * error, name
        assert float(fewer.standard_error.sel(parameter=name)) < 2.0 * error, name


@pytest.mark.parametrize(
    ("spoil", "match"),
    [
        (lambda data: data.assign(friction=data.friction * np.nan), "none of the 4 steps and"),
        (lambda data: data.assign(sigma=("time", np.full(data.time.size, -8e6))), "must be > 0"),
        (lambda data: data.isel(time=slice(None, None, -1)), "times must increase"),
        (lambda data: data.isel(time=slice(0, ROWS)), "no step and no hold"),
    ],
)
def test_records_that_cannot_be_fitted_are_refused(data, spoil, match):
    with pytest.raises(rs.ParameterError, match=match):
        rs.fit(spoil(data), START, per_step=True)


@pytest.mark.parametrize(
    ("changed", "match"),
    [
        ({"per_step": "hold"}, r"per_step = 'hold' is not True or False\. Give per_step=True"),
        ({"loading": rs.Loading.steps(1e-6, (1.0, 1e-5))}, "Leave it out, or fit one window"),
        ({"against": "cycles"}, "Leave out one of them"),
    ],
)
def test_settings_that_do_not_go_together(data, changed, match):
    with pytest.raises(rs.ParameterError, match=match):
        rs.fit(data, START, **({"per_step": True} | changed))


@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
def test_a_window_that_begins_soon_after_a_step_has_a_free_start():
    """The change before is not over: a start in steady sliding would bias the fit."""
    speeds = (SLOW, FAST, SLOW, FAST)
    soon = experiment(SLIDER, speeds, 120e-6, 500, seed=3, noise=1e-4)
    windows = windows_of(soon)
    assert windows[0].slip_since_change == np.inf
    assert windows[1].slip_since_change == pytest.approx(60e-6, rel=0.02)
    result = rs.fit(soon, SLIDER, per_step=True, errors="covariance")
    deviation = [
        (result[name][1:] - getattr(SLIDER, name)) / result.standard_error.sel(parameter=name)[1:]
        for name in FREE
    ]
    assert np.abs(deviation).max() < 3.5


def test_windows_contain_the_sliding_before_and_after(data):
    windows = windows_of(data)
    assert [window.kind for window in windows] == ["step", "step", "hold", "step"]
    first, second, hold, last = windows
    assert first.end == second.t
    assert hold.end == last.t
    assert first.begin == pytest.approx(first.t / 2)
    # the sliding before is at most as long as the sliding after, and at most half of it is used
    assert second.begin == pytest.approx(second.t - 25.0, abs=0.1)
    assert last.end > float(data.time[-1])
    assert last.part(data).time[-1] == data.time[-1]
    assert first.part(data).time[-1] < first.end


def test_many_rows_before_a_short_step_are_left_out():
    """A run-in of hours adds only `ROWS` rows to the window of a step of seconds."""
    t = np.concatenate([np.arange(0.0, 1000.0, 1.0), np.arange(1000.0, 1010.0, 0.01)])
    delta_lp = 1e-6 * np.maximum(t, 10.0 * t - 9000.0)
    friction = 0.6 + 1e-4 * np.random.default_rng(1).normal(size=t.size)
    columns = {"delta_lp": ("time", delta_lp), "friction": ("time", friction)}
    (window,) = windows_of(xarray.Dataset(columns, {"time": t}))
    assert window.t == pytest.approx(1000.0, abs=0.01)
    assert window.begin == pytest.approx(1000.0 - 100.0, abs=6.0)


@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
def test_steps_of_normal_stress_give_alpha():
    """a, b, Dc and K are held at estimates from velocity steps, with their errors."""
    slider = SLIDER.replace(alpha=0.25)
    loading = rs.Loading.steps(SLOW, (150.0, FAST), (220.0, SLOW))
    loading = loading.sigma_step(400.0, "8.8 MPa").sigma_step(600.0, "9.6 MPa")
    t = np.arange(2000) * 0.4  # stress steps at a sample: between two, its time is uncertain
    run = rs.simulate(slider, loading, t[-1], times=t, rtol=1e-9)
    noise = 1e-4 * np.random.default_rng(3).normal(size=t.size)
    data = run[["delta_lp", "sigma"]].assign(friction=run.tau / run.sigma + noise)
    result = rs.fit(data, START.replace(alpha=0.1), per_step=True, errors="covariance")
    assert result.kind.values.tolist() == ["step", "step", "normal stress", "normal stress"]
    np.testing.assert_allclose(result.step_t[2:], [400.0, 600.0], atol=0.5)
    np.testing.assert_allclose(result.sigma, [8e6, 8e6, 8e6, 8.8e6], rtol=1e-6)
    assert np.isnan(result.alpha[:2]).all()
    assert np.isnan(result.a[2:]).all()
    error = result.standard_error.sel(parameter="alpha")[2:].values
    assert (np.abs(result.alpha[2:].values - 0.25) < 3.0 * error).all()
    assert ((error > 0.001) & (error < 0.03)).all()
    # alone, with the parameters of the steps taken for exact, the error is smaller
    part = windows_of(data)[2].part(data)
    held = dict(
        zip(("a", "b", "Dc"), result.shared.sel(parameter=["a", "b", "Dc"]).values, strict=True)
    )
    at = START.replace(**held, K=float(np.nanmedian(result.K)), alpha=0.1)
    alone = rs.fit(part, at, free=("alpha",), errors="covariance")
    assert float(alone.alpha) == pytest.approx(float(result.alpha[2]), rel=0.02)
    assert float(alone.standard_error.sel(parameter="alpha")) < 0.95 * error[0]


def test_the_mean_of_estimates():
    """The mean is weighted without scatter, and plain with a large scatter."""
    rng = np.random.default_rng(2)
    errors = np.array([1.0, 2.0, 4.0])
    exact = mean_of(np.array([5.0, np.nan, 5.0, 5.0]), np.insert(errors, 1, np.nan))
    assert exact == (5.0, pytest.approx((1.0 + 0.25 + 1 / 16) ** -0.5), 0.0)
    values = 10.0 + 3.0 * rng.normal(size=400)
    mean, error, scatter = mean_of(values, np.full(400, 0.1))
    assert scatter == pytest.approx(3.0, rel=0.1)
    assert mean == pytest.approx(values.mean(), abs=1e-3)
    assert error == pytest.approx(values.std() / 20.0, rel=0.05)
    assert np.isnan(mean_of(np.array([np.nan]), np.array([np.nan]))).all()


def test_the_slider_of_all_steps(under_both):
    """It has shared estimates, or else medians over the steps."""
    slider = rs.fitted_slider(under_both, law="slip")
    assert slider.law == "slip"
    for name in ("a", "b", "Dc"):
        shared = under_both.shared.sel(law="slip", parameter=name)
        assert getattr(slider, name) == pytest.approx(float(shared), rel=1e-12)
    assert pytest.approx(float(under_both.K.sel(law="slip").median()), rel=1e-12) == slider.K
    assert slider.sigma == SLIDER.sigma
    with pytest.raises(rs.ParameterError, match="several laws"):
        rs.fitted_slider(under_both)
