"""Very long records: means over blocks of rows, and text that is read in blocks."""

import json

import numpy as np
import pytest

import ratestate as rs
from ratestate.errors import RecordWarning
from ratestate.records.reading import read_lab
from ratestate.records.reading import text as text_files
from ratestate.records.reading.rows import MAX_ROWS, block_means, block_starts

DT, FACTOR = 0.01, 10
N = 20_000


def record(path, noise=0.0, lost=(), step=100.003):
    """Steps from 1 to 10 um/s at `step`, friction with white noise, without the `lost` rows."""
    t = np.arange(N) * DT
    x = np.where(t < step, t, step + 10 * (t - step))
    mu = 0.6 + 0.01 * np.sin(t / 7) + noise * np.random.default_rng(1).normal(size=N)
    keep = np.setdiff1d(np.arange(N), lost)
    header = "Time (s), Disp (um), Friction, Normal stress (MPa)"
    columns = np.transpose([t, x, mu, 20 + 0 * t])[keep]
    np.savetxt(path, columns, "%.8f", delimiter=",", header=header, comments="")
    return path, t, x, mu


def test_means_over_blocks(tmp_path):
    path, t, x, mu = record(tmp_path / "r.csv", noise=1e-3)
    with pytest.warns(RecordWarning, match=r"rows are averaged in blocks of 10: 2,000 remain, "
                      r"one every 100 ms instead of every 10 ms\. .*rows=None"):  # fmt: skip
        data = read_lab(path, max_rows=2000)
    assert "20,000 rows are averaged" in json.loads(data.attrs["notes"])[0]
    for name, values in (("time", t), ("delta_lp", 1e-6 * x), ("friction", mu)):
        expected = values.reshape(-1, FACTOR).mean(axis=1)
        np.testing.assert_allclose(data[name], expected, rtol=1e-7, atol=1e-9)
    # white noise of friction is less by the root of 10, no more and no less
    slow = 0.6 + 0.01 * np.sin(data.time.values / 7)
    ratio = float((data.friction - slow).std()) / 1e-3 * FACTOR**0.5
    assert 0.95 < ratio < 1.05
    # and the step stays where it is, to better than a row
    np.testing.assert_allclose(data.segment_t, [t[4:6].mean(), 100.003], atol=1e-3)
    np.testing.assert_allclose(data.segment_V, [1e-6, 1e-5], rtol=1e-4)


def test_nothing_is_averaged_of_as_many_rows_as_are_allowed(tmp_path):
    path, *_ = record(tmp_path / "r.csv")
    for rows in (N, None, MAX_ROWS, np.int64(N)):
        data = read_lab(path, max_rows=rows)  # warnings are errors
        assert data.sizes["time"] == N
    with pytest.warns(RecordWarning, match="in blocks of 2: 10,000 remain"):
        assert read_lab(path, max_rows=N - 1).sizes["time"] == N // 2


@pytest.mark.parametrize("rows", [999, 0, -1, 1e6, "all", True])
def test_numbers_of_rows_refused(tmp_path, rows):
    path, *_ = record(tmp_path / "r.csv")
    with pytest.raises(rs.ParameterError, match=r"rows = .* whole number from 1,000 on"):
        read_lab(path, max_rows=rows)


def test_an_oscillation_is_weakened_as_stated():
    """By sin(pi B/P)/(pi B/P) over blocks of B, and not aliased at the new rate."""
    for period, most in ((0.4, 0.91), (0.1, 1e-6)):
        t = np.arange(N) * DT
        angle = 2 * np.pi * t / period
        starts, factor = block_starts(N, np.zeros(0, int), N // FACTOR)
        assert factor == FACTOR
        after = np.hypot(block_means(np.sin(angle), starts), block_means(np.cos(angle), starts))
        exact = np.sin(np.pi * 0.1 / period) / (FACTOR * np.sin(np.pi * DT / period))
        np.testing.assert_allclose(after, abs(exact), atol=1e-10)
        assert after.max() < most


def test_blocks_cover_all_rows_once():
    rng = np.random.default_rng(2)
    for _ in range(50):
        n = int(rng.integers(1000, 5000))
        gaps = np.unique(rng.integers(1, n, rng.integers(0, 6)))
        starts, factor = block_starts(n, gaps, int(rng.integers(100, 1000)))
        lengths = np.diff(np.append(starts, n))
        assert starts[0] == 0
        assert {*gaps} <= {*starts}
        assert lengths.min() >= 1
        assert lengths.max() < 2 * factor
        short = lengths < factor
        assert {*starts[short]} <= {0, *gaps}  # stretches that are shorter as a whole


def test_blocks_of_text_leave_no_trace(tmp_path, monkeypatch):
    """Odd cells, remarks, blank lines and decimal commas, wherever a block ends."""
    path, *_ = record(tmp_path / "r.csv")
    lines = path.read_text().splitlines()[:3000]
    lines[1500] = lines[1500].replace("20.00", "over")
    lines[1700:1700] = ["# a remark", "", "  % another"]
    lines[2000] += ",1"
    lines[2100] = lines[2100].rpartition(",")[0]
    lines[2200] = lines[2200].replace("20.00000000", "2.0D+01")
    lines += [""] * 1600 + [lines[-1]]
    path.write_text("\n".join(lines))
    whole = text_files.read_text(path)
    monkeypatch.setattr(text_files, "BLOCK", 1000)
    monkeypatch.setattr(text_files, "MAX_HEADER_LINES", 5)
    parts = text_files.read_text(path)
    assert parts.titles == whole.titles
    np.testing.assert_array_equal(parts.lines, whole.lines)
    found = []
    for one, other in zip(parts.columns, whole.columns, strict=True):
        np.testing.assert_array_equal(one.values, other.values)
        odd = np.flatnonzero(np.isnan(one.values))
        cells = [parts.cell(row, one) for row in odd]
        assert cells == [whole.cell(row, other) for row in odd]
        found += cells
    assert sorted(found) == ["'5 cells'"] * 4 + ["'over000000'", "nothing"]
    expected = [*range(2, 1701), *range(1704, 3004), 4604]
    np.testing.assert_array_equal(whole.lines, expected)
    assert whole.columns[3].values[2199 - 3] == 20.0


def test_numbers_are_read_to_the_last_digit(tmp_path):
    """As Python reads them; a fast reader may round them otherwise."""
    rng = np.random.default_rng(3)
    values = rng.uniform(0.1, 1, (2000, 3)) * 10.0 ** rng.integers(-20, 20, (2000, 3))
    path = tmp_path / "r.txt"
    path.write_text("\n".join("\t".join(map(repr, row)) for row in values.tolist()))
    table = text_files.read_text(path)
    np.testing.assert_array_equal(np.transpose([c.values for c in table.columns]), values)
