"""Rows of laboratory files with values that nobody measured; columns that contradict each other."""

import json
import warnings

import h5py
import numpy as np
import pytest

import ratestate as rs
from ratestate.errors import RecordWarning
from ratestate.records.reading import read_lab
from ratestate.records.reading.values import dropouts

N = 300
T = np.arange(N) * 0.1
X = np.where(T < 15, T, 10 * T - 135)
RNG = np.random.default_rng(5)
MU = 0.6 + 0.003 * np.sin(T) + 3e-4 * RNG.normal(size=N)
HEADER = "Time(s)\tDispl(um)\tFriction"
STRESSES = "Time(s)\tDispl(um)\tShear stress (MPa)\tNormal stress (MPa)"


def write(path, *columns, header=HEADER):
    lines = ["\t".join(map(str, row)) for row in zip(*(c.tolist() for c in columns), strict=True)]
    path.write_text("\n".join([header, *lines]) + "\n")
    return path


def put(values, *places):
    """Values with others in some rows."""
    values = values.astype(object)
    for row, other in places:
        values[row] = other
    return values


def left(path, match, rows, friction=MU):
    """That these rows are left out, with such a warning."""
    with pytest.warns(RecordWarning, match=match) as emitted:
        data = read_lab(path)
    assert len(emitted) == 1
    good = np.delete(np.arange(N), rows)
    np.testing.assert_array_equal(data.time, T[good])
    np.testing.assert_allclose(data.friction, friction[good], rtol=1e-12)
    assert abs(float(data.segment_t[1]) - 15) < 1e-3


def told_by(path):
    """A record, and what is reported of it."""
    with warnings.catch_warnings(record=True) as emitted:
        warnings.simplefilter("always")
        data = read_lab(path)
    return data, [str(one.message) for one in emitted]


def test_values_that_nobody_measured(tmp_path):
    path = tmp_path / "r.txt"
    for column in (1, 2):
        columns = [T, X, MU]
        columns[column] = put(columns[column], *((row, -9999) for row in range(10, 150, 20)))
        match = (
            r"7 rows .* -9999 in '(Displ\(um\)|Friction)', a code .*: line 12, line 32, .* 2 more"
        )
        left(write(path, *columns), match, range(10, 150, 20))
    match = r"no rock has \(more than 3\): line 42 \(friction = 12000\), line 43 \(friction = -5\)"
    left(write(path, T, X, put(MU, (40, 12000), (41, -5))), match, [40, 41])
    match = r"1 row .* as a dropout.*: line 102 \(friction = 1.2\)"
    left(write(path, T, X, put(MU, (100, 1.2))), match, [100])
    match = r"1 row .* as a dropout.*: line 102 \(delta_lp = 800 um\)"
    left(write(path, T, put(X, (100, 800)), MU), match, [100])


def test_rows_without_normal_stress(tmp_path):
    for sigma, match in [
        (0.0, r"with normal stress .*: line 2 \(sigma = 0 Pa\)"),
        (4e-4, r"no rock has .*: line 2 \(friction = 29990\)"),
    ]:
        normal = np.where(T < 2, sigma, 20.0)
        path = write(tmp_path / "r.txt", T, X, 20 * MU, normal, header=STRESSES)
        left(path, match, np.flatnonzero(T < 2))
    path = write(tmp_path / "r.txt", T, X, 20 * MU, 0 * T, header=STRESSES)
    with pytest.raises(rs.ParameterError, match=r"only 0 rows are left.*with normal stress"):
        read_lab(path)


def test_normal_stress_beside_friction(tmp_path):
    """Rows where it cannot be are left out and named; a column that is dead throughout is not."""
    header = HEADER + "\tNormal stress (MPa)"
    row = np.arange(N) == 40
    for wrong, match in [
        (0.0, r"1 row .*normal stress outside 100 to 1e\+11 Pa: line 42 \(sigma = 0 Pa\)"),
        (-20.0, r"normal stress .*: line 42 \(sigma = -20 MPa\)"),
        (1e20, r"normal stress .*: line 42 \(sigma = 1e\+17 GPa\)"),
    ]:
        path = write(tmp_path / "r.txt", T, X, MU, np.where(row, wrong, 20.0), header=header)
        left(path, match, [40])
    for normal in (20.0 + 0 * T, 0 * T):
        data = read_lab(write(tmp_path / "r.txt", T, X, MU, normal, header=header))
        np.testing.assert_array_equal(data.friction, MU)
        dead = bool((normal == 0.0).all())
        assert ("sigma" in data) != dead
        assert ("sigma" in json.loads(data.attrs["columns"])) != dead
        note = "sigma is left out: the column 'Normal stress (MPa)' is 0 Pa (its median)"
        assert (note in data.attrs["notes"]) == dead


def test_measured_values_are_kept(tmp_path):
    """Stick-slip, a peak of one sample, the loading from 0 with noise, a spike within the noise."""
    saw = 0.6 + 0.05 * (T % 3.0) / 3.0
    peak = MU + 0.02 * np.exp(-np.maximum(T - 15, 0) / 0.03) * (T >= 15)
    loading = np.minimum(0.6, 0.2 * T) + 1e-3 * RNG.normal(size=N)
    for mu in (saw, peak, loading, put(MU, (50, 0.61)).astype(float), MU.round(3)):
        np.testing.assert_array_equal(read_lab(write(tmp_path / "r.txt", T, X, mu)).friction, mu)


@pytest.mark.parametrize("signs", [(-1, 1), (1, -1), (-1, -1)])
def test_signs_are_turned(tmp_path, signs):
    tau, sigma = 20 * MU * signs[0], 20.0 * signs[1] + 0 * T
    data = read_lab(write(tmp_path / "r.txt", T, X, tau, sigma, header=STRESSES))
    np.testing.assert_allclose(data.friction, MU, rtol=1e-12)
    assert float(data.sigma.min()) == 2e7
    notes = [
        f"{s} is negative throughout"
        for s, sign in zip(("tau", "sigma"), signs, strict=True)
        if sign < 0
    ]
    assert [note.partition(",")[0] for note in json.loads(data.attrs["notes"])] == notes
    if signs == (-1, -1):
        data = read_lab(write(tmp_path / "r.txt", T, X, -MU))
        np.testing.assert_array_equal(data.friction, MU)
        assert "friction is negative" in data.attrs["notes"]


def test_coarse_displacement(tmp_path):
    header = "Time(s)\tDispl(mm)\tVelocity (um/s)\tFriction"
    V = np.where(T < 15, 1.0, 10.0)
    path = write(tmp_path / "r.txt", T, (X / 1000).round(1) + 0.2, V, MU, header=header)
    with pytest.warns(
        RecordWarning, match="moves in steps of 100 um: its resolution is too coarse.*V_load"
    ):
        data = read_lab(path)
    assert data.attrs["found"] == "delta_lp moves in steps of 100 um"
    data = read_lab(path, {"V_load": "Velocity"})
    np.testing.assert_allclose(data.segment_V, [1e-6, 1e-5])
    # a hold that reads one of three numbers, and in the end one more, is one
    still = np.where(T < 1, 10 * T, 10).round() + RNG.integers(-1, 2, N) + (T > 25)
    assert "hold of" in read_lab(write(tmp_path / "r.txt", T, still, MU)).attrs["found"]


def test_velocity_and_displacement_disagree(tmp_path):
    header = "Time(s)\tDispl(um)\tVelocity (um/s)\tFriction"
    V = np.where(T < 15, 1.0, 10.0)
    path = write(tmp_path / "r.txt", T, X, 5 * V, MU, header=header)
    with pytest.warns(
        RecordWarning,
        match=r"'Velocity \(um/s\)' integrates to 8\d\d um, but delta_lp changes by 164 um",
    ):
        read_lab(path)
    read_lab(write(tmp_path / "r.txt", T, X, put(V, (3, "x")), MU, header=header))


@pytest.mark.parametrize(
    ("header", "time", "match"),
    [
        (
            HEADER,
            "00h01m{:05.2f}",
            r"'Time\(s\)' \(time\) has no number.*'00h01m00.00' in line 2",
        ),
        (HEADER, "12:{:02.0f}", r"'12:00' in line 2. Clock times are read as .*\(mm:ss\)"),
        ("Aika (s)\tDispl(um)\tFriction", "{}", r"as columns={'time': 'Aika \(s\)'}"),
        ("Vrijeme\tDispl(um)\tFriction", "{}", r"number, in columns={'time': \.\.\.}"),
        ("t (s)\tslip (um)\tFriction", "{}", r"in columns={'delta_lp': \.\.\.}"),
        ("Disp (um)\tDisp (um)\tmu", "{}", "columns={.delta_lp.: 1}"),
        ("Time (s)\tDisp (um)\tTime (s)", "{}", "columns={'time': 1}"),
        (HEADER, "x x {}", "no line of numbers .it begins 'Time.*' and 'x x 0"),
    ],
)
def test_messages_suggest_a_remedy(tmp_path, header, time, match):
    times = np.array([time.format(t) for t in T])
    columns = (times, X, MU) if " x" not in time else (times,)
    with pytest.raises(rs.ParameterError, match=match):
        read_lab(write(tmp_path / "r.txt", *columns, header=header))


@pytest.mark.parametrize(
    ("header", "factor"),
    [
        ("Time\tDispl\tFriction\n(s)\t(mm)\t()", 1e3),
        ("TIME [S]\tDISPLACEMENT [UM]\tFRICTION", 1),
        ("TIME [MSEC]\tDISPLACEMENT [UM]\tFRICTION", 1e3),
        ("time\tLP_Disp\tmu\nsec\tmic\t.", 1),
    ],
)
def test_units_as_they_are_written(tmp_path, header, factor):
    data = read_lab(write(tmp_path / "r.txt", T, X, MU, header=header))
    np.testing.assert_allclose(data.segment_V, [1e-6 * factor, 1e-5 * factor])
    fortran = [np.array([f"{x:.9e}".replace("e", "D") for x in c]) for c in (T, X, MU)]
    again = read_lab(write(tmp_path / "r.txt", *fortran, header=header))
    np.testing.assert_allclose(again.friction, MU, rtol=1e-9)


def test_stored_files_with_texts_or_damage(tmp_path):
    path = tmp_path / "r.h5"
    with h5py.File(path, "w") as file:
        file["time_s"] = [str(t).encode() for t in T]
        file["disp_um"], file["mu"] = X, MU
    with pytest.raises(rs.ParameterError, match=r"'mu' \(no real numbers, so not read: 'time_s'\)"):
        read_lab(path)
    content = bytearray(path.read_bytes())
    content[1000:1400] = b"\xff" * 400
    path.write_bytes(content)
    with pytest.raises(rs.ParameterError, match=r"r.h5 (is damaged|cannot be read)"):
        read_lab(path)


@pytest.mark.parametrize(
    ("rows", "value"),
    [
        (slice(100, 110), 0.0),
        (slice(0, 5), 0.0),
        (slice(295, 300), 0.0),
        (slice(60, 61), -250.0),
        (slice(100, 140), -250.0),
        (slice(297, 300), 9999.5),
    ],
)
def test_dropouts_of_the_load_point_are_left_out_and_reported(tmp_path, rows, value):
    """They are not holds: the record is found as it is without them."""
    x = 2500 + X + 0.01 * RNG.normal(size=N)
    x[rows] = value
    dropped = np.arange(N)[rows]
    data, told = told_by(write(tmp_path / "r.txt", T, x, MU))
    assert f"{dropped.size} row" in told[0]
    assert (
        f"as a dropout, far off from the rows before and after: line {dropped[0] + 2} (" in told[0]
    )
    np.testing.assert_array_equal(data.time, np.delete(T, dropped))
    np.testing.assert_allclose(data.segment_V, [1e-6, 1e-5], rtol=0.01)


@pytest.mark.parametrize("noise", [0.0, 1e-3])
def test_dropouts_of_the_shear_stress(tmp_path, noise):
    tau, rows = 20 * MU, np.r_[50:58, 200:230]
    tau[rows] = noise * RNG.normal(size=rows.size)
    path = write(tmp_path / "r.txt", T, X, tau, 20.0 + 0 * T, header=STRESSES)
    data, told = told_by(path)
    assert told[0].startswith("r.txt: 38 rows are left out as a dropout")
    np.testing.assert_array_equal(data.time, np.delete(T, rows))
    np.testing.assert_allclose(data.friction, np.delete(MU, rows), rtol=1e-12)


def test_other_changes_are_not_dropouts():
    """A reset, a jump, a hold, a staircase, stick-slip, the beginning at 0, a stop for a while."""
    noisy = X + 0.01 * RNG.normal(size=N)
    reset = np.where(T < 10, noisy, noisy - 10.0)
    jump = np.where(T < 10, noisy, noisy + 50.0)
    begins = np.where(T < 5, 0.0, X - 5.0)
    stairs = np.repeat(np.arange(5.0), N // 5)
    saw = 0.6 + 0.2 * (T % 10.0) / 10.0 + 1e-4 * RNG.normal(size=N)
    for values in (noisy, reset, jump, begins, stairs, saw, MU, X.round(), X.round(-1)):
        assert not dropouts(values, 0.0, N // 2).any()
    stopped = np.where((T > 5) & (T < 9), 0.0, 1.0)
    assert not dropouts(stopped, 0.0, 1).any()


def test_every_dropout_is_found_and_nothing_else():
    rng = np.random.default_rng(2)
    for n in (120, 1000, 3000):
        x = 2000 + np.cumsum(np.where(np.arange(n) < n // 2, 0.1, 3.0)) + 0.02 * rng.normal(size=n)
        wanted = np.zeros(n, bool)
        for first in rng.integers(5, n - 20, 3):
            wanted[first : first + int(rng.integers(1, 12))] = True
        np.testing.assert_array_equal(dropouts(np.where(wanted, 0.0, x), 0.0, n // 2), wanted)


def test_zeros_at_the_end_do_not_turn_the_load_point(tmp_path):
    """More than a twentieth of the rows: its end is below its beginning."""
    x = np.where(np.arange(N) < N - 40, X + 1.0, 0.0)
    path = write(tmp_path / "r.txt", T, x, MU)
    left(path, r"40 rows are left out as a dropout", np.arange(N - 40, N))
    assert float(told_by(path)[0].segment_V[-1]) == pytest.approx(1e-5, rel=1e-3)


def still(folder, friction):
    t = np.arange(friction.size) * 0.1
    return write(folder / "x.txt", t, 10 * t, friction)


def noisy(n=600, digits=6, noise=3e-4):
    rng = np.random.default_rng(5)
    return np.round(0.6 + noise * rng.standard_normal(n), digits)


def test_a_channel_at_the_end_of_its_range(tmp_path):
    friction = noisy()
    friction[200:260] = 0.65
    message = r"friction stays at 0.65 from 20 s to 25.9 s, 60 rows, .*end of its range.*failed"
    with pytest.warns(RecordWarning, match=message):
        data = read_lab(still(tmp_path, friction))
    assert "60 rows" in data.attrs["notes"]


@pytest.mark.parametrize(("rows", "warned"), [(19, False), (20, True)])
@pytest.mark.parametrize("at", [0, 300, -1])
def test_a_constant_value_is_reported_from_20_rows_on(tmp_path, rows, warned, at):
    friction = noisy()
    first = at if at >= 0 else friction.size - rows
    friction[first : first + rows] = 0.61
    _, told = told_by(still(tmp_path, friction))
    assert [f"{rows} rows" in one for one in told] == [True] * warned


@pytest.mark.parametrize(("rows", "warned"), [(22, False), (40, True)])
def test_coarse_digits_repeat_by_chance(tmp_path, rows, warned):
    friction = noisy(digits=3, noise=6e-4)
    assert 0.35 < np.mean(np.diff(friction) == 0.0) < 0.5
    friction[300 : 300 + rows] = 0.61
    assert len(told_by(still(tmp_path, friction))[1]) == warned


def test_a_record_without_noise_may_stand_still(tmp_path):
    t = np.arange(600)
    friction = 0.6 + 0.01 * np.where(t < 200, 0.0, np.exp(-(t - 200) / 50))
    assert "stays" not in read_lab(still(tmp_path, friction)).attrs["notes"]
