"""What the page does when the server cannot be reached, or refuses."""

import contextlib
import signal

from conftest import Shown, serving
from websockets.sync.client import connect

from ratestate_explorer.app import MOST_PAGES

DROPPED = "The last click had no effect, because the connection to ratestate was lost"
TRIED = "() => document.querySelector('#banner').textContent.includes('tries again in 2 s')"
BEGUN = "() => document.querySelector('#task-start').textContent == 'Reset the sliders'"


def test_a_long_text_is_refused_and_the_connection_stays(show):
    shown = show(f"K={'1' * 9000}")
    assert "K has no text of at most 64 characters" in shown.text("#problem-K")
    assert (
        shown.text("#stale") == "The page shows the last valid values (K = 960 MPa/m). Correct K."
    )
    sockets = []
    shown.page.on("websocket", lambda socket: sockets.append(socket.url))
    shown.type("K", "0.96 GPa/m")
    shown.page.wait_for_selector("#problem-K", state="hidden")
    shown.type("K", "\u00b5" * 9000)
    shown.page.wait_for_selector("#problem-K:visible")
    assert "K has no text of at most 64 characters" in shown.text("#problem-K")
    shown.set("M", "500 kg/m^2")
    assert shown.numbers["K/Kc"] == "0.8"
    assert sockets == []


def test_one_page_too_many_asks_ever_more_seldom(browser, server):
    address = server.address.replace("http", "ws").rstrip("/") + "/socket"
    with contextlib.ExitStack() as stack:
        for _ in range(MOST_PAGES):
            stack.enter_context(connect(address, origin=server.address.rstrip("/")))
        page = stack.enter_context(contextlib.closing(browser.new_context())).new_page()
        page.goto(server.address)
        for seconds in ("0.5", "1"):
            page.wait_for_function(f"""() => document.querySelector('#banner').textContent
                .match(/too many pages are open: close one\\)\\. .* tries again in {seconds} s/)""")


def test_what_is_shown_is_grey_while_its_answer_takes_long(show, server):
    """As while a solver is compiled: here the server sleeps."""
    stale = "() => document.body.classList.contains('stale')"
    shown = show()
    shown.set("K", "800 MPa/m")
    assert not shown.page.evaluate(stale)
    server.process.send_signal(signal.SIGSTOP)
    try:
        shown.type("K", "700 MPa/m")
        shown.page.wait_for_function(stale, timeout=5_000)
    finally:
        server.process.send_signal(signal.SIGCONT)
    shown.wait()
    shown.page.wait_for_function(f"() => !({stale})()")


def test_a_lost_connection_says_so_and_comes_back(browser):
    color = "e => getComputedStyle(e).color"
    with contextlib.ExitStack() as stack:
        with serving() as first:
            shown = Shown(browser, first.address)
            page = shown.page
            stack.callback(shown.context.close)
            before = shown.numbers
        assert first.process.returncode == 130
        # after a line for each kernel that had to be compiled
        assert first.process.errors.endswith("interrupted: the explorer has ended\n")
        banner = page.wait_for_selector("#banner.lost:visible")
        assert "is lost" in banner.inner_text()
        usual = page.eval_on_selector("body", color)
        assert page.eval_on_selector("#headline", color) == usual  # it is of what is shown
        page.click("#csv")  # what is shown is what is typed
        assert shown.text("#banner").startswith(DROPPED)
        page.wait_for_function(TRIED, timeout=60_000)  # it stays until something is done
        assert shown.text("#banner").startswith(DROPPED)
        # what is changed without a connection is marked
        shown.type("K", "2 GPa/m")
        assert shown.text("#banner").startswith("The connection to ratestate is lost")
        assert page.eval_on_selector("#headline", color) != usual
        page.click("#python")  # what is typed is not read
        assert shown.text("#banner").startswith(DROPPED)
        assert shown.numbers == before
        page.wait_for_function("() => location.hash.includes('K=2+GPa')")  # the first step
        page.click("#tasks-open")
        page.click(".choices button >> nth=1")
        page.click("#task-start")
        shown.type("a", "0.004")  # which the task keeps
        port = int(first.address.split(":")[2].strip("/"))
        with serving(port):
            page.wait_for_selector("#banner", state="hidden", timeout=60_000)
            shown.wait()
            page.wait_for_function(BEGUN)
            assert shown.entry("a") != "0.004"  # it begins as it should
            for _ in range(3):  # what the task began with, what was changed meanwhile, K
                page.click("#undo")
                page.wait_for_timeout(500)
            assert page.is_disabled("#undo")  # to come back was no step
            shown.wait()
            assert shown.numbers == before


def test_a_late_problem_of_a_chart_is_not_told(modules):
    told = modules.evaluate(
        """async () => { const { Standing } = await import('/js/standing/standing.js');
        const told = [];
        const standing = Object.assign(Object.create(Standing.prototype), {
            ids: { chart: 5, window: 7, branch: 6 },
            tellOfMap: text => told.push(text),
            map: { missing: () => told.push('missing') },
            diagram: { tell: text => told.push(text) } });
        const concerned = [
            standing.refuse({ id: 4, problems: { map: 'old' } }),
            standing.refuse({ id: 5, problems: { map: 'chart' } }),
            standing.refuse({ id: 7, problems: { map: 'window' } }),
            standing.refuse({ id: 3, problems: { branch: 'old' } }),
            standing.refuse({ id: 6, problems: { branch: 'branch' } }),
            standing.refuse({ id: 6, problems: { K: 'wrong' } })];
        return [concerned, told] }"""
    )
    assert told[0] == [True, True, True, True, True, False]
    assert told[1] == ["chart", "missing", "window", "missing", "branch"]
