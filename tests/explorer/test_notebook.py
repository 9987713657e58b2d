"""The explorer from Python: one server, for notebooks of this machine, and what is refused."""

import http.client
import threading

import pytest
import xarray

import ratestate as rs
from ratestate.paper.parameters import FIG4
from ratestate_explorer import charts, exports, notebook
from ratestate_explorer.deadline import TimeUp


def threads():
    return [t for t in threading.enumerate() if t.name == "ratestate-explorer"]


@pytest.fixture(autouse=True)
def ended():
    yield
    rs.explore(FIG4, 1e-4).close()
    assert not threads()


def policy(url):
    host = url.split("/")[2]
    connection = http.client.HTTPConnection(host, timeout=30)
    connection.request("GET", "/")
    answer = connection.getresponse()
    assert b"ratestate" in answer.read()
    connection.close()
    return answer.getheader("Content-Security-Policy")


def test_one_server_for_all_pages():
    assert not threads()
    pages = [rs.explore(FIG4, V) for V in (1e-4, "0.2 m/s")]
    assert not threads()  # until one is shown
    first, second = (page.url.partition("#") for page in pages)
    assert len(threads()) == 1
    assert threads()[0].daemon
    assert first[0] == second[0]
    assert "V_lp=100+um%2Fs" in first[2]
    assert "V_lp=200+mm%2Fs" in second[2]
    assert repr(pages[0]) == f"ratestate explorer at {pages[0].url}"
    assert f'src="{first[0]}#a=0.005&amp;b=0.008&amp;' in pages[0]._repr_html_()
    assert f'<a href="{first[0]}#a=0.005&amp;' in pages[0]._repr_html_()
    pages[0].close()
    assert not threads()
    assert pages[1].url.startswith("http://127.0.0.1:")
    assert len(threads()) == 1


def test_notebooks_of_this_machine_may_frame_it():
    ancestors = policy(rs.explore(FIG4, 1e-4).url).partition("frame-ancestors ")[2]
    assert ancestors.split() == [
        f"{scheme}://{name}:*"
        for scheme in ("http", "https")
        for name in ("localhost", "127.0.0.1")
    ] + ["vscode-webview:", "vscode-file:"]


def test_pages_open_in_the_browser(monkeypatch):
    opened = []
    monkeypatch.setattr(notebook.webbrowser, "open", opened.append)
    page = rs.explore(FIG4, 1e-4)
    page.open()
    assert opened == [page.url]


def test_saving_needs_no_server(tmp_path, monkeypatch):
    monkeypatch.setattr(charts, "SIZES", (3, 4))
    path = rs.explore(FIG4, "0.1 mm/s").save(tmp_path / "rig.html")
    assert "Saved page" in path.read_text()
    assert not threads()


def test_saving_may_take_too_long(tmp_path, monkeypatch):
    monkeypatch.setattr(charts, "SIZES", (3, 4))

    def endless(*_):
        raise TimeUp

    monkeypatch.setattr(exports, "picture_of", endless)
    with pytest.raises(
        rs.SolverError, match=r"takes more than 300 s to compute\. Nothing was saved"
    ):
        rs.explore(FIG4, "0.1 mm/s").save(tmp_path / "rig.html")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("slider", "V_lp", "said"),
    [
        (FIG4, "3 MPa", "V_lp = '3 MPa' is a stress"),
        (FIG4, rs.logspace("V_lp", 1e-6, 1.0, 3), "V_lp is an array, and the explorer shows one"),
        (
            FIG4.replace(
                K=xarray.DataArray([1e8, 2e8], dims="K"), M=xarray.DataArray([0.0], dims="M")
            ),
            1e-4,
            "K, M are arrays",
        ),
        (FIG4.replace(K=1e25), 1e-4, "is out of range"),
    ],
)
def test_wrong_arguments_are_refused(slider, V_lp, said):
    with pytest.raises(rs.ParameterError, match=said):
        rs.explore(slider, V_lp)
    assert not threads()
