"""What the page does when the server cannot be reached, or refuses."""

import contextlib

import pytest
from conftest import Shown, serving
from websockets.sync.client import connect

from ratestate.interfaces.explorer.service.app import MOST_PAGES


@pytest.mark.parametrize("pasted", ["1" * 9000, "\u00b5" * 9000])
def test_a_long_text_is_refused_and_the_connection_stays(show, pasted):
    shown = show()
    sockets = []
    shown.page.on("websocket", lambda socket: sockets.append(socket.url))
    shown.type("K", pasted)
    shown.page.wait_for_selector("#problem-K:visible")
    assert "K is longer than 64 characters" in shown.text("#problem-K")
    shown.type("M", "500 kg/m^2")
    shown.wait()
    assert shown.numbers["K/Kc"] == "0.8"
    other = show(f"K={pasted}")  # and so of a link
    assert "longer than 64 characters" in other.text("#problem-K")
    assert sockets == []


def test_one_page_too_many_asks_ever_more_seldom(browser, server):
    address = server.address.replace("http", "ws").rstrip("/") + "/socket"
    with contextlib.ExitStack() as stack:
        for _ in range(MOST_PAGES):
            stack.enter_context(connect(address, origin=server.address.rstrip("/")))
        page = stack.enter_context(contextlib.closing(browser.new_context())).new_page()
        page.goto(server.address)
        for seconds in ("0.5", "1", "2"):
            page.wait_for_function(f"""() => document.querySelector('#banner').textContent
                .includes('too many pages are open; close one); trying again in {seconds} s')""")


def test_what_is_changed_without_a_connection_is_marked(browser):
    with contextlib.ExitStack() as stack:
        with serving() as first:
            shown = Shown(browser, first.address)
            stack.callback(shown.context.close)
        shown.page.wait_for_selector("#banner.lost:visible")
        weight = "e => getComputedStyle(e).fontWeight"
        assert shown.page.eval_on_selector("#headline", weight) == "550"  # it is of what is shown
        shown.type("K", "2 GPa/m")
        assert shown.page.eval_on_selector("#headline", weight) == "400"


def test_a_lost_connection_says_so_and_comes_back(browser):
    with contextlib.ExitStack() as stack:
        with serving() as first:
            shown = Shown(browser, first.address)
            stack.callback(shown.context.close)
            before = shown.numbers
        assert first.process.returncode == 130
        # after a line for each kernel that had to be compiled
        assert first.process.errors.endswith("interrupted; the explorer has ended\n")
        banner = shown.page.wait_for_selector("#banner.lost:visible")
        assert "is lost" in banner.inner_text()
        shown.type("K", "2 GPa/m")
        assert shown.numbers == before
        port = int(first.address.split(":")[2].strip("/"))
        with serving(port):
            shown.page.wait_for_selector("#banner", state="hidden", timeout=60_000)
            shown.wait()
            assert shown.numbers["K/Kc"] == "1.667"
