"""A chunk of a sweep: solved, and stored if there is a store."""

import json
from typing import Any, NamedTuple

from ..dynamics.results import versions
from ..engine import backend
from ..errors import StoreError
from .chunks import Chunks
from .manifest import listed
from .origin import differences, origin
from .solve import failed, solve


class Outcome(NamedTuple):
    """What became of a chunk."""

    chunk: int
    failed: int  # cases without an answer
    variables: dict | None  # None: they are in the store


class Tasks(NamedTuple):
    """What all chunks of a sweep share."""

    chunks: Chunks
    kinds: dict
    store: Any  # `Store`, or None
    device: str
    kind: dict | None = None  # of processor, of all workers; None: of any

    def outcome(self, i, variables):
        """Store the variables of chunk i, if there is a store; `Outcome`."""
        number = failed(variables)
        if self.store is None:
            return Outcome(i, number, variables)
        from .store import write

        write(self.store, i, variables)
        return Outcome(i, number, None)

    def do(self, i, part, progress=None, threads=1, stop=None):
        """Solve chunk i, the cases of the call `part`; `Outcome`."""
        with backend.use(threads=threads, stop=stop, device=self.device):
            return self.outcome(i, solve(part, self.kinds, progress))


def do_elsewhere(tasks, i, part, expected):
    """`Tasks.do` in a worker process of the versions expected, on the kind of processor."""
    if versions() != expected:
        raise StoreError(
            f"a worker has other versions, {json.loads(versions())}, than those expected, "
            f"{json.loads(expected)}: results would differ in their last digits; install the same"
        )
    if lines := differences(json.loads(expected), tasks.kind, origin(tasks.device)):
        raise StoreError(
            f"a worker differs from those before it, and results would in their last digits; use "
            f"workers of one kind, or take them all with mixed=True (--mixed):{listed(lines)}"
        )
    return tasks.do(i, part)
