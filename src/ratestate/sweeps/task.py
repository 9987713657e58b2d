"""One chunk of a sweep: solved, and stored if there is a store."""

import json
from typing import Any, NamedTuple

from ..dynamics.results import versions
from ..engine import backend
from ..errors import StoreError
from .chunks import Chunks
from .manifest import as_lines
from .origin import origin, origin_differences
from .solve import count_failed, solve


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
    processor: dict | None = None  # kind that all workers must have; None: any

    def outcome(self, i, variables):
        """Store the variables of chunk i, if there is a store; return its `Outcome`."""
        number = count_failed(variables)
        if self.store is None:
            return Outcome(i, number, variables)
        from .store import write

        write(self.store, i, variables)
        return Outcome(i, number, None)

    def do(self, i, part, progress=None, threads=1, stop=None):
        """Solve chunk i, whose cases are those of the call `part`; return its `Outcome`."""
        with backend.use(threads=threads, stop=stop, device=self.device):
            return self.outcome(i, solve(part, self.specs, progress))


def do_on_worker(tasks, i, part, expected):
    """`Tasks.do` in a worker process, which must have the expected versions and processor."""
    if versions() != expected:
        raise StoreError(
            f"a worker has other versions, {json.loads(versions())}, than those expected, "
            f"{json.loads(expected)}: results would differ in their last digits; install the same"
        )
    if lines := origin_differences(json.loads(expected), tasks.processor, origin(tasks.device)):
        raise StoreError(
            f"a worker differs from those before it, and results would in their last digits; use "
            f"workers of one kind, or take them all with mixed=True (--mixed):{as_lines(lines)}"
        )
    return tasks.do(i, part)
