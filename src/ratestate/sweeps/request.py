"""What a sweep is to compute, and the store that it goes to."""

import contextlib
import dataclasses
import functools
from typing import Any

import numpy as np

from .calls import check_cases
from .chunk_size import cases_per_chunk
from .chunks import chunks_of
from .origin import origin
from .progress import ProgressReport
from .solve import form_of
from .task import Tasks


@dataclasses.dataclass(frozen=True)
class SweepRequest:
    """What a sweep is to compute, and where; checked by `sweep`, not here."""

    name: str  # of the function
    call: Any  # its checked call
    chunk: int | None  # cases of a chunk; None: chosen by `chunk_size`
    device: str
    mixed: bool
    backend: Any  # `Threads` or `Cluster`
    progress: bool

    @functools.cached_property
    def form(self):
        """`Form` of the result."""
        return form_of(self.call)

    @functools.cached_property
    def origin(self):
        """`origin` of what does the work: with a cluster, a worker's."""
        return self.backend.run(origin, self.device)

    def divide(self):
        """`Chunks` of the sweep; measures the cost of a case if `chunk` is None.

        ParameterError where the arguments of a case contradict each other.
        """
        cases = self.chunk or cases_per_chunk(self)
        chunks = chunks_of(self.call.batch.sizes, cases)
        check_cases(self.call, chunks)
        return chunks

    def outcomes(self, chunks, done, store=None, failed=0):
        """Solve all chunks that are not done; yield each `Outcome` when it is ready.

        store : open `Store`, or None
        failed : number of failed cases among those done
        """
        tasks = Tasks(chunks, self.form.specs, store, self.device)
        numbers = np.flatnonzero(~done).tolist()
        label = f"sweep of {self.name}"
        with ProgressReport(label, chunks, done, failed, quiet=not self.progress) as report:
            any_kind = self.mixed or self.backend.shared
            processor = None if any_kind else self.origin["processor"]
            outcomes = self.backend.outcomes(tasks, self.call, numbers, report, processor)
            with contextlib.closing(outcomes):
                for outcome in outcomes:
                    report.finished(outcome)
                    yield outcome
