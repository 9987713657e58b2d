"""One server and one browser for the tests of the page."""

import contextlib
import os
import re
import shutil
import signal
import subprocess
import sys
import types

import pytest
from user_laws import MINE

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
EXPLORE = [
    "-c",
    "from ratestate.interfaces.cli import main; main()",
    "explore",
    "--no-browser",
    "--port",
]


@contextlib.contextmanager
def serving(port=0, *options):
    """An explorer in a process of its own, ended by Ctrl-C."""
    process = subprocess.Popen(
        [sys.executable, *EXPLORE, str(port), *options],
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
            executable_path=CHROMIUM, args=["--no-sandbox"] if root else []
        )
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    """With a user's law."""
    path = tmp_path_factory.mktemp("laws") / "mine.py"
    path.write_text(MINE)
    with serving(0, "--law-file", str(path)) as found:
        yield found


@pytest.fixture(scope="module")
def browser():
    if not CHROMIUM:
        pytest.skip("no chromium: make browser, or tools/chromium.sh, installs Debian's")
    with browsing() as found:
        yield found
