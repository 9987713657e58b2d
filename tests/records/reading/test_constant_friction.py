"""`read_lab` warns of friction that stays at one value for longer than its noise allows."""

import warnings

import numpy as np
import pytest

import ratestate as rs


def read(tmp_path, friction):
    t = np.arange(friction.size) * 0.1
    rows = [f"{a:.1f}\t{10 * a:.2f}\t{mu:.6f}" for a, mu in zip(t, friction, strict=True)]
    path = tmp_path / "x.txt"
    path.write_text("\n".join(["time(s)\tdisplacement(um)\tfriction", *rows]))
    return rs.read_lab(path)


def record(n=600, digits=6, noise=3e-4):
    rng = np.random.default_rng(5)
    return np.round(0.6 + noise * rng.standard_normal(n), digits)


def test_a_channel_at_the_end_of_its_range(tmp_path):
    friction = record()
    friction[200:260] = 0.65
    message = (
        r"friction stays at 0.65 from 20 s to 25.9 s, 60 rows, .*end of its range.*dropped out"
    )
    with pytest.warns(rs.RecordWarning, match=message):
        data = read(tmp_path, friction)
    assert "60 rows" in data.attrs["notes"]


@pytest.mark.parametrize(("rows", "warned"), [(19, False), (20, True)])
@pytest.mark.parametrize("at", [0, 300, -1])
def test_how_long_it_must_be(tmp_path, rows, warned, at):
    friction = record()
    first = at if at >= 0 else friction.size - rows
    friction[first : first + rows] = 0.61
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        read(tmp_path, friction)
    assert [f"{rows} rows" in str(one.message) for one in caught] == [True] * warned


@pytest.mark.parametrize(("rows", "warned"), [(22, False), (40, True)])
def test_coarse_digits_repeat_by_chance(tmp_path, rows, warned):
    friction = record(digits=3, noise=6e-4)
    assert 0.35 < np.mean(np.diff(friction) == 0.0) < 0.5
    friction[300 : 300 + rows] = 0.61
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        read(tmp_path, friction)
    assert len(caught) == warned


def test_a_record_without_noise_may_stand_still(tmp_path):
    t = np.arange(600)
    friction = 0.6 + 0.01 * np.where(t < 200, 0.0, np.exp(-(t - 200) / 50))
    assert "stays" not in read(tmp_path, friction).attrs["notes"]
