"""Foreign files are read in a child, and harm nothing else."""

import os
import struct
import subprocess
import sys
import textwrap

import h5py
import numpy as np
import pytest
import readers
import scipy.io
from lab_files import MU, T, X

import ratestate as rs
from ratestate import ParameterError
from ratestate.records.kit.processes import read_isolated

RECORD = {"Time_s": T, "disp_um": X, "mu": MU}
LINUX = pytest.mark.skipif(sys.platform != "linux", reason="Linux limits memory")


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "r.dat"
    path.write_text("content")
    return path


def mat(path, **how):
    scipy.io.savemat(path, RECORD, **how)
    return path


def test_results_of_a_reader_come_back_from_a_child(path):
    with pytest.warns(UserWarning, match=r"^r.dat: odd$"):
        found, (child, main) = read_isolated(readers.good, path, "anything")
    assert child != os.getpid()
    assert main is None  # what the user's script does is not done again
    x = np.arange(6.0).reshape(2, 3)
    for name, values in {"x": x, "column": x[:, 1], "turned": x.T, "none": x[:0]}.items():
        np.testing.assert_array_equal(found[name], values)
        assert found[name].flags.writeable
    assert found["text"] == "content"


@pytest.mark.parametrize(
    ("reader", "message"),
    [
        ("killed", r"as a thing: it ended the process that read it \(SIGSEGV\). Copy it again"),
        ("left", r"it ended the process that read it \(exit code 7\)"),
        ("stumbled", "r.dat cannot be read as a thing: IndexError: x{288}. Copy it again"),
        ("nested", "r.dat cannot be read as a thing: RecursionError"),
        ("refused", "^r.dat is not wanted"),
        pytest.param("greedy", "it needs more memory than 1.1 GB", marks=LINUX),
    ],
)
def test_errors_of_a_child_are_parameter_errors(path, reader, message):
    with pytest.raises(ParameterError, match=message):
        read_isolated(getattr(readers, reader), path, "a thing")


@pytest.mark.parametrize("program", ["/no/such/python", "/bin/false"])
def test_without_a_child_it_is_read_here(path, monkeypatch, program):
    monkeypatch.setattr(sys, "executable", program)
    with pytest.warns(UserWarning, match="odd"):
        _, (process, _) = read_isolated(readers.good, path, "anything")
    assert process == os.getpid()


def test_a_script_needs_no_guard_and_a_folder_may_hold_anything(tmp_path):
    mat(tmp_path / "r.mat")
    (tmp_path / "random.py").write_text("raise SystemExit('the wrong random')")
    (tmp_path / "numpy.py").write_text("raise SystemExit('the wrong numpy')")
    script = tmp_path / "bin" / "script.py"
    script.parent.mkdir()
    script.write_text(
        textwrap.dedent(
            """
            import ratestate as rs
            from ratestate.records.reading import open_table

            def here(path):
                raise SystemExit("it was read in this process, not in the child")

            here.__module__, here.__qualname__ = "ratestate.records.reading.open_table", "read_mat"
            open_table.read_mat = here
            print("once", rs.read_lab("r.mat").sizes["time"])
            """
        )
    )
    done = subprocess.run(
        [sys.executable, script], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout == "once 120\n"


def test_an_unknown_type_in_a_mat_file_is_refused(tmp_path):
    """SciPy looks an unknown type up in a table without looking, and dies of it."""
    path = mat(tmp_path / "r.mat")
    double = struct.pack("<II", 9, 8 * T.size)
    assert double in path.read_bytes()
    path.write_bytes(path.read_bytes().replace(double, struct.pack("<II", 0, 8 * T.size), 1))
    with pytest.raises(ParameterError, match=r"r.mat cannot be read as a MAT file: .*\. Copy it"):
        rs.read_lab(path)


def test_a_small_file_that_asks_for_much(tmp_path):
    with h5py.File(tmp_path / "r.h5", "w") as file:
        file.create_dataset("time_s", shape=(3 * 10**9,), dtype="f8", chunks=(10**6,))
    with pytest.raises(ParameterError, match=r"'time_s' would take 2.4e\+10 bytes, but the file"):
        rs.read_lab(tmp_path / "r.h5")
    path = tmp_path / "packs.h5"
    with h5py.File(path, "w") as file:  # what really is packed so well is read
        t = np.arange(24_000.0)
        for name, values in {"time_s": t, "disp_um": 10 * t, "mu": 0.6 + t % 2}.items():
            file.create_dataset(name, data=values, compression="gzip", shuffle=True)
        file.create_dataset("sn_MPa", data=np.full(24_000, 5.0), compression="gzip")
    assert rs.read_lab(path).sizes["time"] == 24_000
