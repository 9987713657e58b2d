"""Taking a page along: figures, the page as one file that opens without a server, frames."""

import contextlib
import functools
import http.server
import threading
import types
from html import escape

import pytest
from conftest import DRAWN, NUMBERS, Shown
from explorer_links import CASES

import ratestate as rs
from ratestate.paper.parameters import FIG2, FIG4

VIBRATION = CASES["quasi-harmonic"]
MAPPED = "() => document.querySelector('#regimes li:not([hidden])')"


@contextlib.contextmanager
def opened(browser, address, **look):
    """A page without any network, which complains of nothing and asks for nothing but itself."""
    context = browser.new_context(**look)
    context.set_offline(True)
    page = context.new_page()
    complaints, requests = [], []
    page.on("console", lambda m: complaints.append(m.text))
    page.on("pageerror", lambda e: complaints.append(str(e)))
    page.on("request", lambda r: requests.append(r.url))
    page.goto(address)
    page.wait_for_function(DRAWN, timeout=60_000)
    yield page
    page.wait_for_timeout(200)
    context.close()
    assert complaints == []
    assert requests == [address.partition("#")[0]]


@pytest.fixture(scope="module")
def taken(browser, server, tmp_path_factory):
    """What is taken along of a page with another run pinned; and what the page was."""
    shown = Shown(browser, server.address, VIBRATION.replace("K=900", "K=800"))
    shown.page.click("#pin")
    shown.set("K", "900 MPa/m")
    shown.page.wait_for_function(MAPPED)
    folder = tmp_path_factory.mktemp("taken")
    yield types.SimpleNamespace(
        page=shown.saved("page", folder),
        svg=shown.saved("svg", folder),
        headline=shown.text("#headline"),
        numbers=shown.numbers,
    )
    shown.context.close()
    assert shown.complaints == []


def test_a_saved_page_opens_without_a_server(browser, taken, show):
    assert taken.svg.name == "ratestate.svg"
    text = taken.svg.read_text()
    assert "<!-- Quasi-harmonic vibration at 50.59 Hz" in text
    assert "<!-- $K$ = 800 MPa/m -->" in text
    # a link has no say
    address = f"{taken.page.as_uri()}#K=1 GPa/m"
    with opened(browser, address, viewport={"width": 1440, "height": 900}) as page:
        assert page.inner_text("#headline").replace("\N{NO-BREAK SPACE}", " ") == taken.headline
        assert page.evaluate(NUMBERS) == taken.numbers
        assert page.title() == taken.headline.replace("\u03c4/\u03c3", "tau/sigma")
        page.wait_for_function(MAPPED)
        assert page.inner_text("#pins li").startswith("K = 800 MPa/m")
        assert page.input_value("#entry-V_lp") == "3.2 mm/s"
        assert "ratestate explore" in page.inner_text("#saved")
        height = "document.documentElement.scrollHeight - innerHeight"
        assert page.evaluate(height) == 0
        # what it shows can be read at the pointer
        page.hover("#stress-chart .u-over")
        page.wait_for_function(
            "() => document.querySelector('#readout').innerText.includes('= 0.5')"
        )
        before = page.evaluate("document.querySelector('#phase-canvas').toDataURL()")
        page.check("#whole")
        assert page.evaluate("document.querySelector('#phase-canvas').toDataURL()") != before
        # and nothing in it can be changed
        names = page.evaluate(
            """[...document.querySelectorAll(':is(button, input, select):enabled')]
                .filter(x => x.checkVisibility()).map(x => x.id)"""
        )
        of_charts = {"pin", "play", "played", "playing-speed", "tab-map", "tab-branch", "closer"}
        of_charts |= {"whole", "sound", "volume", ""}  # the last one removes a pin
        assert {*names} == {"link"} | of_charts
        box = page.locator("#map-canvas").bounding_box()
        page.mouse.click(box["x"] + 120, box["y"] + 60)
        page.evaluate("location.hash = 'K=2 GPa/m'")
        page.wait_for_timeout(300)
        assert page.input_value("#entry-K") == "900 MPa/m"
        assert page.is_disabled("#undo")
        assert page.evaluate("document.body.dataset.asked") == "1"
        # its link is to the live one
        href = page.get_attribute("#saved a", "href")
    assert href.startswith("http://127.0.0.1:8765/#")
    live = show(href.partition("#")[2])
    assert live.text("#headline") == taken.headline


@contextlib.contextmanager
def served(folder):
    """A folder at a port of localhost, as a notebook's server is."""
    quiet = type("Quiet", (http.server.SimpleHTTPRequestHandler,), {"log_message": lambda *_: None})
    handler = functools.partial(quiet, directory=str(folder))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://localhost:{server.server_port}"
        server.shutdown()


def framed(browser, folder, html):
    """The headline within a frame of a page of another server; None if the frame is refused."""
    (folder / "index.html").write_text(
        f'<!doctype html><meta charset="utf-8"><title>n</title>{html}'
    )
    with served(folder) as address, browser.new_page() as page:
        page.goto(address)
        frame = page.wait_for_selector("iframe").content_frame()
        if frame.url.startswith("chrome-error:"):
            return None
        frame.wait_for_function(DRAWN, timeout=60_000)
        return frame.inner_text("#headline")


def test_only_a_page_opened_by_a_notebook_may_be_framed(browser, server, tmp_path):
    page = rs.explore(FIG2, "3.2 mm/s")
    try:
        html = page._repr_html_()
        assert framed(browser, tmp_path, html).startswith("Quasi-harmonic vibration at 50.59")
    finally:
        page.close()
    assert framed(browser, tmp_path, f'<iframe src="{server.address}"></iframe>') is None


def test_a_saved_page_may_be_a_frames_source(browser, taken, tmp_path):
    """As in a notebook on another machine."""
    text = escape(taken.page.read_text())
    html = f'<iframe srcdoc="{text}" width="900" height="860"></iframe>'
    assert framed(browser, tmp_path, html).startswith("Quasi-harmonic vibration at 50.59")


def test_each_frame_undoes_its_own_changes(browser, tmp_path):
    pages = [rs.explore(FIG4.replace(K=K), 1e-4) for K in (5e8, 6e8)]
    (tmp_path / "index.html").write_text("".join(page._repr_html_() for page in pages))
    drawn = "K => document.querySelector('#entry-K')?.value.startsWith(K)"
    settled = f"K => decodeURIComponent(location.hash).includes(`K=${{K}}`) && ({drawn})(K)"
    with served(tmp_path) as address, contextlib.closing(browser.new_context()) as context:
        page = context.new_page()
        page.goto(address)
        first, second = page.frames[1:]
        for frame, K in ((first, "500"), (second, "600")):
            frame.wait_for_function(drawn, arg=K, timeout=120_000)

        def change(frame, K):
            frame.fill("#entry-K", f"{K} MPa/m")
            frame.press("#entry-K", "Enter")
            frame.wait_for_function(settled, arg=K)

        for frame, K in ((first, "510"), (second, "610"), (first, "520")):
            change(frame, K)
        first.click("#undo")
        first.wait_for_function(settled, arg="510")
        second.click("#undo")
        second.wait_for_function(settled, arg="600")
        assert first.input_value("#entry-K") == "510 MPa/m"
        assert (second.is_disabled("#undo"), second.is_disabled("#redo")) == (True, False)
        first.click("#redo")
        first.wait_for_function(settled, arg="520")
        assert first.is_disabled("#redo")
        for K in ("510", "500"):
            first.click("#undo")
            first.wait_for_function(settled, arg=K)
        change(first, "530")  # another future
        assert first.is_disabled("#redo")
    pages[0].close()
