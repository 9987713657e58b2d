"""One server and one browser for the tests of the page."""

import contextlib
import os
import re
import shutil
import signal
import subprocess
import sys
import types
from pathlib import Path

import pytest

DRAWN = """() => { const { asked, drawn } = document.body.dataset;
    return asked && Number(drawn) >= Number(asked) }"""
NUMBERS = """() => Object.fromEntries([...document.querySelectorAll('#numbers div')].map(
    group => [group.firstChild.textContent, group.lastChild.textContent]))"""
#: of a canvas, or of a box [x, y, right, down] in it: pixels that are about as a role's colour
PAINTED = """([canvas, role, box]) => {
    const c = document.querySelector(canvas), ratio = c.width / c.clientWidth;
    const color = getComputedStyle(document.documentElement).getPropertyValue(`--${role}`);
    const wanted = color.match(/[0-9a-f]{2}/g).map(h => parseInt(h, 16));
    const copy = new OffscreenCanvas(c.width, c.height).getContext('2d');
    copy.drawImage(c, 0, 0);
    const part = box ? box.map(px => Math.round(px * ratio)) : [0, 0, c.width, c.height];
    const { data, width, height } = copy.getImageData(...part);
    const rows = [];
    for (let i = 0; i < data.length; i += 4)
        if (wanted.every((value, k) => Math.abs(data[i + k] - value) < 12))
            rows.push(Math.floor(i / 4 / width) / height);
    return { count: rows.length, share: rows.length / (width * height),
        top: Math.min(...rows), bottom: Math.max(...rows) } }"""
#: from now on, ids of what moves on the page by itself, perhaps only within some elements
SHIFTS = """within => { window.shifts = [];
    new PerformanceObserver(list => shifts.push(...list.getEntries().flatMap(
        e => e.sources.map(s => s.node && (within ? s.node.closest?.(within)?.id
            : s.node.id || s.node.nodeName))))).observe({ type: 'layout-shift' }) }"""
# The headless one starts no browser around the page.
CHROMIUMS = ("chromium-headless-shell", "chromium", "chromium-browser")
CHROMIUM = next(filter(None, map(shutil.which, CHROMIUMS)), None)
VIEWPORT = {"width": 1280, "height": 860}
#: what a page can be given when it is open already
EMULATED = {"viewport", "color_scheme", "reduced_motion"}
# The map of a page that rests is of few sliders, or its computing would slow down all tests.
# Records are read without a child process, which takes 2 s a file; `test_record` has one.
COARSE = """
from ratestate import machine
from ratestate.interfaces.cli import main
from ratestate_explorer import charts
charts.SIZES, charts.WINDOW_SIZE = (4, 6), 16
machine.is_child = True
main()
"""


@contextlib.contextmanager
def serving(port=0, *options):
    """An explorer in a process of its own, ended by Ctrl-C."""
    process = subprocess.Popen(
        [sys.executable, "-c", COARSE, "explore", "--no-browser", "--port", str(port), *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        address = re.search(r"http://\S+", process.stdout.readline())[0]
        yield types.SimpleNamespace(address=address, process=process)
    finally:
        process.send_signal(signal.SIGINT)
        process.errors = process.communicate(timeout=20)[1]


@contextlib.contextmanager
def browsing():
    """Chromium without a window."""
    from playwright.sync_api import sync_playwright

    root = hasattr(os, "geteuid") and os.geteuid() == 0
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=CHROMIUM, args=["--disable-gpu", *(["--no-sandbox"] if root else [])]
        )
        yield browser
        browser.close()


class Shown:
    """A page of the explorer, and what went on in it."""

    def __init__(self, browser, address, fragment="", **look):
        self.context = browser.new_context(accept_downloads=True, **{"viewport": VIEWPORT} | look)
        self.context.grant_permissions(["clipboard-read", "clipboard-write"])
        self.page = self.context.new_page()
        self.complaints, self.requests = [], []
        self.page.on("console", lambda m: self.complaints.append(m.text))
        self.page.on("pageerror", lambda e: self.complaints.append(str(e)))
        self.page.on("request", lambda r: self.requests.append(r.url))
        self.address = address
        self.open(fragment)

    def open(self, fragment):
        """Load the page."""
        self.page.goto(f"{self.address}#{fragment}")
        self.wait()

    def go(self, fragment):
        """Follow a link while the page is open."""
        asked = "asked => document.body.dataset.asked !== asked"
        before = self.page.evaluate("document.body.dataset.asked")
        self.page.evaluate("fragment => { location.hash = fragment }", fragment)
        self.page.wait_for_function(asked, arg=before)
        self.wait()

    def leave(self):
        """Leave the page, as if it had never been open, for a picture of the same server.

        The next page loads in half the time then, as its process is there already.
        """
        self.page.evaluate("sessionStorage.clear()")
        self.page.mouse.move(0, 0)
        self.page.goto(f"{self.address}icon.svg")
        self.complaints.clear()
        self.requests.clear()

    def emulate(self, viewport=VIEWPORT, color_scheme="light", reduced_motion="no-preference"):
        """Give the page a window and a reader's preferences."""
        self.page.set_viewport_size(viewport)
        self.page.emulate_media(color_scheme=color_scheme, reduced_motion=reduced_motion)

    def wait(self):
        """Until everything asked for is drawn."""
        self.page.wait_for_function(DRAWN, timeout=120_000)

    def painted(self, canvas, role, box=None):
        """Return what a canvas has of the colour of a role: see `PAINTED`."""
        return types.SimpleNamespace(**self.page.evaluate(PAINTED, [canvas, role, box]))

    def watch_shifts(self, within=None):
        self.page.evaluate(SHIFTS, within)

    @property
    def shifts(self):
        """What has moved since; typed text, which has no node for scripts, is left out."""
        return [what for what in self.page.evaluate("shifts") if what]

    def saved(self, kind, folder=None):
        """Return the path of a file that a button gives, under its own name in a folder."""
        with self.page.expect_download() as download:
            self.page.click(f"#{kind}")
        if folder is None:
            return download.value.path()
        path = folder / download.value.suggested_filename
        download.value.save_as(path)
        return path

    def copied_link(self):
        """Return the fragment of the address that the page copies."""
        self.page.click("#link")
        return self.page.evaluate("navigator.clipboard.readText()").partition("#")[2]

    def type(self, symbol, text):
        self.page.fill(f"#entry-{symbol}", text)
        self.page.press(f"#entry-{symbol}", "Enter")

    def set(self, symbol, text):
        """Type a value, and wait for its picture."""
        self.type(symbol, text)
        self.wait()

    def choose(self, menu, value=None, **how):
        """Choose from a menu, and wait for the picture."""
        self.page.select_option(menu, value, **how)
        self.wait()

    def entry(self, symbol):
        return self.page.input_value(f"#entry-{symbol}")

    def text(self, selector):
        return self.page.inner_text(selector).replace("\N{NO-BREAK SPACE}", " ")

    @property
    def numbers(self):
        return self.page.evaluate(NUMBERS)


@pytest.fixture(scope="session")
def server(tmp_path_factory):
    """With a user's law."""
    from user_laws import MINE

    path = tmp_path_factory.mktemp("laws") / "mine.py"
    path.write_text(MINE)
    with serving(0, "--law-file", str(path)) as found:
        yield found


class Opened:
    """The browser, once a test needs it, and its pages between two tests."""

    def __init__(self):
        self.stack = contextlib.ExitStack()
        self.browser, self.modules, self.resting = None, None, []

    def close(self):
        self.stack.close()
        self.__init__()


OPENED = Opened()


@pytest.fixture(scope="module")
def browser():
    if not CHROMIUM:
        pytest.skip("no chromium: make browser, or tools/chromium.sh, installs Debian's")
    if not OPENED.browser:
        OPENED.browser = OPENED.stack.enter_context(browsing())
    return OPENED.browser


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(nextitem):
    """Close the browser after the last test of this folder: with it open no event loop can run."""
    yield
    if nextitem is None or Path(__file__).parent not in nextitem.path.parents:
        OPENED.close()


@pytest.fixture
def modules(browser, server):
    """A page that is none of the explorer, but can import its modules."""
    if not OPENED.modules:
        OPENED.modules = browser.new_page()
        OPENED.modules.goto(f"{server.address}js/motion/pace.js")
    return OPENED.modules


@pytest.fixture
def show(browser, server):
    """Open pages; in the end, nothing was complained of, and no other host asked."""
    with contextlib.ExitStack() as stack:

        def opened(fragment="", **look):
            if OPENED.resting and look.keys() <= EMULATED:
                shown = OPENED.resting.pop()
                shown.emulate(**look)
                shown.open(fragment)
            else:
                shown = Shown(browser, server.address, fragment, **look)
            stack.callback(finish, shown, look)
            return shown

        def finish(shown, look):
            complaints, requests = shown.complaints.copy(), {*shown.requests}
            if look.keys() <= EMULATED:
                shown.leave()
                OPENED.resting.append(shown)
            else:
                shown.context.close()
            assert complaints == []
            assert {url.split("/")[2] for url in requests if url[:5] != "blob:"} == {
                server.address.split("/")[2]
            }

        yield opened
