"""Seeds that are the same each time; laws that a test registers are forgotten after it."""

import gc
import sys

import hypothesis
import pytest
from threadpoolctl import threadpool_limits

from ratestate.friction.laws import LAW_NAMES, LAWS
from ratestate.model.quantities import QUANTITIES

# Other examples at each run, and more of them: --hypothesis-profile=default.  A busy machine
# breaks deadlines.
hypothesis.settings.register_profile(
    "reproducible", derandomize=True, deadline=None, max_examples=60
)
hypothesis.settings.load_profile("reproducible")


def pytest_addoption(parser):
    parser.addoption("--draw-anew", action="store_true", help="take pictures as they are for right")


@pytest.fixture(autouse=True)
def laws_as_before():
    """Forget, after each test, the laws that it has registered: others list all laws there are."""
    before = [(table, dict(table)) for table in (LAWS, LAW_NAMES, QUANTITIES)]
    yield
    for table, old in before:
        table.clear()
        table.update(old)


def pytest_runtest_setup(item):
    """Write pictures of few pixels, which no test looks at; read NetCDF without a child process.

    A child takes 0.3 s a file.  `test_processes` and `test_files` test reading with one.
    """
    if layout := sys.modules.get("ratestate.plot.layout"):
        layout.DPI = 40
    if machine := sys.modules.get("ratestate.machine"):
        machine.is_child = item.path.parent.name in ("files", "cli", "scenario", "paper")


@pytest.fixture(scope="module")
def in_one_process():
    """Fit all steps of an experiment here: a child takes longer to start than it saves."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("ratestate.records.kit.processes.cores", lambda: 1)
        yield


@pytest.fixture
def law_file(tmp_path):
    """Write a law file."""

    def write(text, name="mine.py"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return write


@pytest.fixture
def looks_as_before(request):
    """Check that a figure is what is kept of it under a name; return it."""
    import pictures  # with it comes matplotlib

    return lambda fig, name: pictures.check(fig, name, request.config.getoption("--draw-anew"))


def pytest_collection_finish():
    """Collect garbage seldom, and never among thousands of tests and what they import."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(100_000, 20, 20)


def pytest_sessionstart():
    """Give BLAS one thread a worker: more than there are cores spin for longer than they work."""
    threadpool_limits(1, user_api="blas")
