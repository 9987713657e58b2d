"""Seeds that are the same each time; kernels that parallel workers compile once."""

import fcntl
import gc
import os
from pathlib import Path

import hypothesis
import pytest
from textbook import OF_LAW
from threadpoolctl import threadpool_limits

import ratestate as rs
from ratestate.friction.laws import LAW_OF, LAWS, ONE_LENGTH
from ratestate.model.quantities import QUANTITIES

# Other examples at each run, and more of them: --hypothesis-profile=default.  A busy machine
# breaks deadlines.
hypothesis.settings.register_profile(
    "reproducible", derandomize=True, deadline=None, max_examples=60
)
hypothesis.settings.load_profile("reproducible")

SLIDERS = [
    rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, M=3e3, K=9e8, law=law, **own)
    for law, own in OF_LAW.items()
]
#: A kernel's source -> what compiles it for a slider's law, or loads it from the cache
KERNELS = {
    "return_map.py": lambda slider: rs.limit_cycle(slider, 1e-2, rtol=1e-3),
    "march.py": lambda slider: rs.simulate(slider, rs.Loading.constant(1e-2), 1e-4, V_start=1e-3),
}


def pytest_addoption(parser):
    parser.addoption("--draw-anew", action="store_true", help="take pictures as they are for right")


@pytest.fixture(autouse=True)
def laws_as_before():
    """Forget, after each test, the laws that it has registered: others list all laws there are."""
    before = [(table, dict(table)) for table in (LAWS, LAW_OF, ONE_LENGTH, QUANTITIES)]
    yield
    for table, old in before:
        table.clear()
        table.update(old)


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
    """Check that a figure is what is kept of it under a name."""
    import pictures  # with it comes matplotlib

    return lambda fig, name: pictures.check(fig, name, request.config.getoption("--draw-anew"))


def pytest_collection_finish():
    """Collect garbage seldom, and never among thousands of tests and what they import."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(100_000, 20, 20)


def pytest_sessionstart():
    """Let workers begin with different kernels, and wait for those that others are compiling.

    Of BLAS each has one thread: more than there are cores spin for longer than they work.
    """
    threadpool_limits(1, user_api="blas")
    worker = os.environ.get("PYTEST_XDIST_WORKER", "")
    if not worker:
        return
    sources, first = list(KERNELS), int(worker.removeprefix("gw")) % len(KERNELS)
    for source in sources[first:] + sources[:first]:
        with (Path(rs.__file__).parent / "engine" / source).open() as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            for slider in SLIDERS:
                KERNELS[source](slider)
