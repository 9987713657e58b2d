"""One chunk of a sweep: solved, and stored if there is a store."""

from typing import Any, NamedTuple

from ..engine import backend
from ..errors import StoreError
from . import sentence
from .chunks import Chunks
from .manifest import as_lines
from .origin import origin, origin_differences
from .solve import count_failed, solve
from .store import write


class Outcome(NamedTuple):
    """The result of a chunk."""

    chunk: int
    failed: int  # cases without an answer
    variables: dict | None  # None: they are in the store


class Tasks(NamedTuple):
    """What all chunks of a sweep share."""

    chunks: Chunks
    specs: dict  # variable -> `VariableSpec`
    store: Any  # `Store`, or None
    device: str

    def outcome(self, i, variables):
        """Store the variables of chunk i, if there is a store; return its `Outcome`."""
        number = count_failed(variables)
        if self.store is None:
            return Outcome(i, number, variables)
        write(self.store, i, variables)
        return Outcome(i, number, None)

    def do(self, i, part, progress=None, threads=1, stop=None):
        """Solve chunk i, whose cases are those of the call `part`; return its `Outcome`."""
        with backend.use(threads=threads, stop=stop, device=self.device):
            return self.outcome(i, solve(part, self.specs, progress))


def call_on_worker(expected, device, function, *arguments):
    """Call a function in a worker process, which must have the expected `origin`.

    With ``processor`` None, any kind of processor will do.
    """
    now = origin(device)
    if now["versions"] != expected["versions"]:
        versions = {"now": now["versions"], "expected": expected["versions"]}
        raise StoreError(sentence("origin.worker_version", **versions))
    if lines := origin_differences(expected, now):
        raise StoreError(sentence("origin.worker", lines=as_lines(lines)))
    with backend.use(threads=1, device=device):
        return function(*arguments)
