"""Laboratory records that a page sends: what is drawn of them, what is refused."""

import contextlib
import http.client
import io
import json
import re
import threading
import time
from urllib.parse import urlencode

import h5py
import numpy as np
import pytest
import xarray as xr
from explorer_server import page, read, served
from synthetic_records import SLIDER, STEP, record

from ratestate import machine
from ratestate.model.units import to_si
from ratestate_explorer import lab_record, wire
from ratestate_explorer.deadline import Deadline
from ratestate_explorer.picture import MOST_SENT

T = np.arange(9000) * 0.1
X = np.where(T < 400, 3 * T, 10 * T - 2800)
MU = 0.6 + 1e-3 * np.sin(T) - 0.01 * (T == 500.0)
HEADER = ("Time(s)", "disp_um", "mu", "normal stress (MPa)")


def text(header, columns=None):
    columns = columns or (T, X, MU, np.full_like(T, 20.0))
    rows = (",".join(f"{x:.7g}" for x in row) for row in zip(*columns, strict=True))
    return "\n".join([",".join(header), *rows]).encode()


GOOD = text(HEADER)


@pytest.fixture
def without_child(monkeypatch):
    """Read records in this process: a child takes up to 2 s."""
    monkeypatch.setattr(machine, "is_child", True)


def answered(contents, name="r.csv", **choices):
    return read(lab_record.answer_record(name, contents, choices, threading.Event()))


def test_a_record_is_drawn_with_its_conditions(without_child):
    header, arrays = answered(GOOD)
    assert (header["kind"], header["name"], header["problem"]) == ("record", "r.csv", "")
    assert header["found"] == "velocity step 3 -> 10 um/s at 400.0 s (1200 um)"
    units = ["s", "um", "", "MPa"]
    assert header["columns"] == [list(column) for column in zip(HEADER, units, strict=True)]
    assert header["chosen"] == {"time": 1, "delta_lp": 2, "friction": 3, "sigma": 4}
    assert set(arrays) == {"time", "friction", "segment_t", "segment_V"}
    assert 1000 < arrays["time"].size == arrays["friction"].size <= MOST_SENT < T.size
    assert arrays["friction"].min() == pytest.approx(MU.min(), abs=1e-6)
    np.testing.assert_allclose(arrays["segment_t"], [0.0, 400.0], rtol=1e-9)
    np.testing.assert_allclose(arrays["segment_V"], [3e-6, 1e-5], rtol=1e-9)
    assert header["begin"] == arrays["segment_t"][1]
    V_from, V_lp = arrays["segment_V"]
    step = {"time": header["begin"], "V_from": V_from, "V_lp": V_lp, "sigma": 2e7}
    assert header["conditions"] == step


ENTRIES = {"a": "0.01", "b": "0.014", "Dc": "20 um", "K": "60 GPa/m", "sigma": "1 MPa"}
ENTRIES |= {"M": "0", "mu0": "0.6", "V0": "1 um/s", "V_lp": "1 um/s"}


@pytest.fixture(scope="module")
def of_a_step():
    """A record whose parameters are known, as a file."""
    t = np.arange(0.0, 240.0, 0.2)
    data = record(SLIDER, STEP, t, noise=2e-4, seed=18)
    return text(HEADER, (t, data.delta_lp * 1e6, data.friction, np.full_like(t, 20.0)))


def test_a_record_is_fitted_from_the_fields_of_the_page(without_child, of_a_step):
    entries = ENTRIES | {"law": SLIDER.law}
    found = lab_record.answer_record("r.csv", of_a_step, {"fit": entries}, Deadline(60.0))
    header, arrays = read(found)
    assert header["problem"] == ""
    assert arrays["friction_fit"].size == arrays["friction"].size
    assert np.std(arrays["friction_fit"] - arrays["friction"]) < 2.5e-4
    said = header["fitted"][0]
    for name in ("a", "b", "Dc"):
        *numbers, unit = re.search(rf"\b{name} = (\S+) \xb1 (\S+)( um)?[,.]", said).groups()
        value, error = (to_si(name, number + (unit or "")) for number in numbers)
        truth = getattr(SLIDER, name)
        assert abs(value - truth) < 4.0 * error < 0.2 * truth


def test_a_fit_ends_with_a_problem_and_on_a_stop(without_child, of_a_step):
    def problem(entries, deadline):
        choices = {"fit": entries}
        header, arrays = read(lab_record.answer_record("r.csv", of_a_step, choices, deadline))
        assert not arrays
        return header["problem"]

    entries = ENTRIES | {"law": "slip"}
    assert problem(entries | {"a": "-1"}, Deadline(60.0)).startswith("a = '-1' must be > 0")
    assert problem(entries, Deadline(0.0)).startswith("the fit takes more than 0 s. Give the times")
    stopped = Deadline(60.0)
    threading.Timer(0.05, stopped.set).start()
    assert problem(entries, stopped) == "the fit was stopped"


@pytest.mark.parametrize(
    ("V", "begin", "expected"),
    [
        ([1e-6], 5.0, (5.0, None, 1e-6)),
        ([0.0], 5.0, (5.0, None, None)),
        ([1e-6, 0.0, 1e-6], 15.0, (15.0, None, 1e-6)),
        ([1e-6, 0.0, 2e-6, 3e-6], 15.0, (35.0, 2e-6, 3e-6)),
        ([0.0, 2e-6], 15.0, (15.0, None, 2e-6)),
    ],
)
def test_conditions_of_a_record(V, begin, expected):
    t = 5.0 + 10.0 * np.arange(len(V))
    found = xr.Dataset({"segment_t": ("segment", t), "segment_V": ("segment", V)})
    assert lab_record._begin(found) == begin
    names = ("time", "V_from", "V_lp", "sigma")
    assert lab_record.conditions(found) == dict(zip(names, (*expected, None), strict=True))


def test_what_is_missing_can_be_chosen(without_child):
    contents = text(("clock", "channel A", "channel B", "load"))
    header, arrays = answered(contents)
    assert header["problem"].startswith("no column is recognized as time, and the file has 'clock'")
    assert header["problem"].endswith(". Choose the column below.")
    assert (header["columns"][1], arrays, header["chosen"]) == (["channel A", ""], {}, {})
    columns = {"time": 1, "delta_lp": 2, "friction": 3}
    header, _ = answered(contents, columns=columns)
    wrong = "the column 'clock' (time) has no unit. Choose its unit, or another column, below."
    assert (header["problem"], header["chosen"]) == (wrong, columns)
    units = {"time": "s", "delta_lp": "um"}
    header, arrays = answered(contents, columns=columns, units=units, time=["100 s", None])
    assert header["problem"] == ""
    assert arrays["time"][0] == 100.0
    header, _ = answered(contents, columns=columns, units=units, time=["1000 s", None])
    assert header["problem"].endswith(". Give other times below.")


@pytest.mark.parametrize(
    ("name", "contents", "problem"),
    [
        ("r.png", b"\x89PNG\r\n\x1a\n" + bytes(99), "r.png is neither text nor HDF5 nor MAT. Save"),
        ("", b"", "the file is empty. A record has rows such as"),
        (
            "r" * 300 + ".csv",
            b"PK\x03\x04",
            "r" * 251 + ".csv is a spreadsheet or an archive. Save",
        ),
    ],
)
def test_files_that_are_not_records_are_refused(without_child, name, contents, problem):
    header, arrays = answered(contents, name)
    assert header["problem"].startswith(problem)
    assert (header["columns"], header["chosen"], arrays) == ([], {}, {})


def test_a_small_file_that_unpacks_to_a_large_one():
    stored = io.BytesIO()
    with h5py.File(stored, "w") as file:
        file.create_dataset("time_s", shape=(10**10,), dtype="f8", chunks=(10**6,))
    header, _ = answered(stored.getvalue(), "r.h5")
    assert "r.h5 is damaged: 'time_s' would take 8e+10 bytes" in header["problem"]


@pytest.mark.parametrize("text", ["[]", "{", '{"path": "/etc/passwd"}', '{"time": NaN}'])
def test_unknown_choices_are_refused(text):
    with pytest.raises(wire.BadQuestion):
        lab_record.choices_of(text)
    assert lab_record.choices_of('{"time": [null, "1 s"]}') == {"time": [None, "1 s"]}


@pytest.fixture(scope="module")
def port():
    with served() as found:
        yield found


def sent(port, page, contents=GOOD, origin="own", **query):
    """Status and answer (its bytes where it is not the page's) of a POST of a file."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    origin = f"http://127.0.0.1:{port}" if origin == "own" else origin
    target = "/record?" + urlencode({"page": page, "name": "r.csv"} | query)
    connection.request("POST", target, contents, {"Origin": origin} if origin else {})
    response = connection.getresponse()
    body, kind = response.read(), response.headers["Content-Type"]
    connection.close()
    return response.status, read(body) if kind == "application/octet-stream" else body


def read_at_once(monkeypatch):
    """A file that has come is read in no time."""
    monkeypatch.setattr(lab_record, "answer_record", lambda *_: wire.answer(None, "record"))


class Reading:
    """Reads the file "first" until it is stopped or `over`, and others at once."""

    def __init__(self):
        self.begun, self.over, self.ended = (threading.Event() for _ in range(3))
        self.stopped = {}

    def answer(self, name, contents, choices, stop):
        self.begun.set()
        until = time.monotonic() + 20.0 * (name == "first")
        while not (stop.wait(0.01) or self.over.is_set()) and time.monotonic() < until:
            pass
        self.stopped[name] = stop.is_set()
        self.ended.set()
        return wire.answer(None, "record", name=name)

    @contextlib.contextmanager
    def of_first(self, port, own):
        """Have the file "first" read meanwhile."""
        first = threading.Thread(target=sent, args=(port, own), kwargs={"name": "first"})
        first.start()
        assert self.begun.wait(20.0)
        yield
        first.join(20.0)


@pytest.fixture
def reading(monkeypatch):
    found = Reading()
    monkeypatch.setattr(lab_record, "answer_record", found.answer)
    return found


class TestServer:
    def test_a_record_is_read_and_not_stored(self, port, tmp_path, monkeypatch):
        monkeypatch.setenv("TMPDIR", str(tmp_path))
        with page(port) as socket:
            choices = json.dumps({"time": ["100 s", None]})
            status, (header, arrays) = sent(port, socket.greeting["page"], choices=choices)
        assert (status, header["problem"], header["name"]) == (200, "", "r.csv")
        assert arrays["time"][0] == 100.0
        assert list(tmp_path.iterdir()) == []

    @pytest.mark.parametrize("origin", [None, "http://evil.example"])
    def test_other_pages_send_nothing(self, port, origin):
        with page(port) as socket:
            found = sent(port, socket.greeting["page"], origin=origin)
        assert found == (403, b"not this host's page")

    def test_a_page_must_be_connected_to_send_a_record(self, port):
        with page(port) as socket:
            own = socket.greeting["page"]
            status, (header, _) = sent(port, own[:-1])
            assert (status, header["problem"][:26]) == (403, "this page is not connected")
            status, (header, _) = sent(port, own, choices="nonsense")
            assert (status, header["problem"][:12]) == (400, "Invalid JSON")
            assert len(own) >= 20
            assert socket.greeting["largest_file"] == 50_000_000
            assert "larger than the 50 MB" in socket.greeting["too_large"]

    @pytest.mark.parametrize("counted", [True, False])
    def test_a_file_above_the_size_limit_is_refused(self, port, monkeypatch, counted):
        monkeypatch.setattr(lab_record, "LARGEST", len(GOOD))
        read_at_once(monkeypatch)
        with page(port) as socket:
            own = socket.greeting["page"]
            for contents, expected in ((GOOD, 200), (GOOD + b"\n", 413)):
                body = contents if counted else iter([contents[:1000], contents[1000:]])
                status, (header, _) = sent(port, own, body)
                assert status == expected
            assert "larger than the 0.2" in header["problem"]

    def test_a_file_must_come_in_time(self, port, monkeypatch):
        monkeypatch.setattr(lab_record, "SECONDS", 0.3)

        def slow():
            yield GOOD[:1000]
            time.sleep(0.6)

        with page(port) as socket:
            status, (header, _) = sent(port, socket.greeting["page"], slow())
        assert (status, header["problem"][:34]) == (408, "the file did not arrive within 0.3")

    def test_the_newest_file_of_a_page_is_read(self, port, reading):
        with page(port) as socket:
            own = socket.greeting["page"]
            with reading.of_first(port, own):
                assert sent(port, own, name="second")[1][0]["name"] == "second"
        assert reading.stopped == {"first": True, "second": False}

    def test_a_file_too_large_stops_no_other(self, port, reading, monkeypatch):
        monkeypatch.setattr(lab_record, "LARGEST", len(GOOD))
        with page(port) as socket:
            own = socket.greeting["page"]
            with reading.of_first(port, own):
                assert sent(port, own, GOOD + b"1")[0] == 413
                reading.over.set()
        assert reading.stopped == {"first": False}

    @pytest.mark.parametrize("leaves", ["page", "request"])
    def test_reading_stops_when_the_page_has_gone(self, port, reading, leaves):
        with page(port) as socket:
            connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
            target = f"/record?name=first&page={socket.greeting['page']}"
            connection.request("POST", target, GOOD, {"Origin": f"http://127.0.0.1:{port}"})
            assert reading.begun.wait(20.0)
            if leaves == "request":
                connection.close()
                assert reading.ended.wait(10.0)
        assert reading.ended.wait(10.0)
        assert reading.stopped == {"first": True}
        connection.close()

    def test_an_earlier_file_is_not_waited_for(self, port, monkeypatch):
        read_at_once(monkeypatch)
        arriving, sent_since = threading.Event(), threading.Event()
        answers = []

        def slow():
            yield GOOD[:1000]
            arriving.set()
            sent_since.wait(20.0)
            yield GOOD[1000:2000]
            time.sleep(0.2)
            yield GOOD[2000:]

        with page(port) as socket:
            own = socket.greeting["page"]
            first = threading.Thread(target=lambda: answers.append(sent(port, own, slow())))
            first.start()
            assert arriving.wait(20.0)
            assert sent(port, own)[0] == 200
            sent_since.set()
            first.join(20.0)
        status, (header, _) = answers[0]
        assert (status, header["problem"]) == (
            409,
            "another file was sent after this one, or its page was closed",
        )
