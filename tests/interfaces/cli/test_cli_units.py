"""The option --units, and reports of a slider whose contact area is known."""

import json

import numpy as np
import pytest
from command_line import call, succeed

from ratestate import limit_cycle
from ratestate.files import read
from ratestate.scenario import load

FILE = """
[slider]
area = "20 cm^2"
a = 0.003
b = 0.006
Dc = "10 um"
sigma = "4 kN"
K = "1.8 MN/m"
M = "6 kg"
law = "Ruina"
[loading]
V_lp = "3.2 mm/s"
[run]
t_end = "0.1 s"
V_start = "3 mm/s"
"""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "contact.toml"
    path.write_text(FILE)
    return path


def test_forces_and_units_in_the_report(file):
    done = call("cycle", file, "--units", "period=ms,V_max=um/s", "--units", "force_amplitude=mN")
    assert (done.exit_code, done.stderr) == (0, "")
    rows = dict(line.split(maxsplit=1) for line in done.stdout.splitlines() if "  " in line.strip())
    cycle = limit_cycle(load(file).slider, "3.2 mm/s")
    assert float(rows["period"].split()[0]) == pytest.approx(1e3 * float(cycle.period), rel=1e-5)
    assert rows["period"].split()[1] == "ms"
    assert rows["V_max"].split()[1] == "um/s"
    force = 4e6 * float(cycle.amplitude)
    assert float(rows["force_amplitude"].split()[0]) == pytest.approx(force, rel=1e-5)
    assert rows["displacement_amplitude"].split()[1] == "um"


def test_the_whole_contact_in_files_and_json(file, tmp_path):
    units = ["--units", "force=kN,acceleration_max=mm/s^2"]
    done = call("run", file, "--out", tmp_path / "x.csv", *units, "--json")
    assert (done.exit_code, done.stderr) == (0, f"wrote {tmp_path / 'x.csv'}\n")
    data = json.loads(done.stdout)["data_vars"]
    np.testing.assert_allclose(
        data["force"]["data"], 2e-6 * np.array(data["tau"]["data"]), rtol=1e-14
    )
    head = (tmp_path / "x.csv").read_text().splitlines()[0].split(",")
    assert {"force [kN]", "acceleration [m/s^2]"} < {*head}
    inertial_force = 4e6 * data["inertial_force"]["data"] / 3000.0  # on 2e-3 m^2, of 6 kg
    assert data["acceleration_max"]["data"] == pytest.approx(1e3 * inertial_force / 2.0)
    assert call("run", file, "--out", tmp_path / "x.nc", *units).exit_code == 0
    written = read(tmp_path / "x.nc")
    assert (written.force.units, written.time.units) == ("kN", "s")
    assert call("run", "--from", tmp_path / "x.nc", "--out", tmp_path / "y.nc").exit_code == 0
    again = read(tmp_path / "y.nc")
    np.testing.assert_array_equal(again.tau, written.tau)
    np.testing.assert_allclose(again.force, 1e3 * written.force, rtol=1e-14)
    assert json.loads(again.attrs["scenario"])["slider"]["area"] == 2e-3


SWEEP = """[sweep]
function = "limit_cycle"
sigma = ["4 kN", "3.5 kN"]
"""


def test_the_whole_contact_of_sweeps(file, tmp_path):
    text = FILE.replace('sigma = "4 kN"\n', "")
    file.write_text(text[: text.index("[run]")] + SWEEP)
    units = ["--units", "force_amplitude=mN,force=N"]
    for more in (["run", file], ["sweep", file, "--store", tmp_path / "x.zarr"]):
        done = succeed(*more, "--out", tmp_path / "x.nc", *units)
        assert "--units: this result has no force\n" in done.stderr
        data = read(tmp_path / "x.nc")
        assert data.force_amplitude.units == "mN"
        force = 1e3 * data.amplitude * np.array([4000.0, 3500.0])
        np.testing.assert_allclose(data.force_amplitude, force, rtol=1e-13)


def test_without_area_nothing_is_of_the_whole_contact(file, tmp_path):
    text = FILE.replace('area = "20 cm^2"\n', "").replace("4 kN", "2 MPa")
    file.write_text(text.replace("1.8 MN/m", "900 MPa/m").replace("6 kg", "3000 kg/m^2"))
    done = call("run", file, "--units", "force=N,t=ms", "--json")
    assert (done.exit_code, done.stderr) == (0, "--units: this result has no force\n")
    document = json.loads(done.stdout)
    assert not {"force", "acceleration"} & document["data_vars"].keys()
    assert document["coords"]["time"]["data"][-1] == 100.0
