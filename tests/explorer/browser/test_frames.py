"""Two explorers in frames of one notebook."""

import contextlib
import http.server
import threading

import pytest

import ratestate as rs
from ratestate.paper.parameters import FIG4


@pytest.fixture
def notebook():
    """The address of a page with two frames."""
    pages = [rs.explore(FIG4.replace(K=K), 1e-4) for K in (5e8, 6e8)]

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write("".join(page._repr_html_() for page in pages).encode())

        def log_message(self, *_):
            pass

    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()
        thread.join(20)
    pages[0].close()


def test_each_frame_undoes_its_own_changes(browser, notebook):
    drawn = "K => document.querySelector('#entry-K')?.value.startsWith(K)"
    settled = f"K => decodeURIComponent(location.hash).includes(`K=${{K}}`) && ({drawn})(K)"
    with contextlib.closing(browser.new_context()) as context:
        page = context.new_page()
        page.goto(notebook)
        first, second = page.frames[1:]
        for frame, K in ((first, "500"), (second, "600")):
            frame.wait_for_function(drawn, arg=K, timeout=120_000)
        for frame, K in ((first, "510"), (second, "610"), (first, "520")):
            frame.fill("#entry-K", f"{K} MPa/m")
            frame.press("#entry-K", "Enter")
            frame.wait_for_function(settled, arg=K)
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
        first.fill("#entry-K", "530 MPa/m")  # another future
        first.press("#entry-K", "Enter")
        first.wait_for_function(settled, arg="530")
        assert first.is_disabled("#redo")
