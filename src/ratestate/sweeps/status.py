"""The status of a store: cases done, failed cases, versions, damage."""

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..engine.model import STATUSES, STEADY_SLIDING
from .solve import ANSWERED
from .store import Store, reading


class StoreStatus(NamedTuple):
    """How much of a sweep a store has, and what made it."""

    path: Path
    function: str
    dims: dict  # dimension -> number of values
    cases: int
    done: int  # cases
    failed: int  # of those done: neither finished nor steady sliding
    steady: int  # of those done, that slide steadily
    chunks: int
    chunks_done: int
    versions: dict  # of the programs that made it
    processor: str  # that made it; "" if it was not recorded
    size: int  # bytes on disk
    flaws: list | None  # of `Flaw`, files that are damaged or missing; None: not verified


def store_status(path, verify=False):
    """Return the `StoreStatus` of the store at a path; StoreError if it cannot be read.

    verify : read all files and check them; chunks with flaws then count as not done
    """
    path = Path(path)
    with reading(path):
        store = Store.open(path)
        chunks, record = store.chunks, store.record
        flaws = store.flaws() if verify else []
        done = store.done()
        done[[flaw.chunk for flaw in flaws if flaw.chunk is not None]] = False
        counts = store.statuses(done)
    processor = record.get("processor", {})
    return StoreStatus(
        path=path,
        function=record.get("function") or record["verb"],
        dims=chunks.sizes,
        cases=math.prod(chunks.sizes.values()),
        done=counts.total(),
        failed=counts.total() - sum(counts[code] for code in ANSWERED),
        steady=counts[STEADY_SLIDING],
        chunks=chunks.number,
        chunks_done=int(done.sum()),
        versions=record["versions"],
        processor="; ".join(processor[key] for key in ("cpu", "gpu") if key in processor),
        size=sum(file.stat().st_size for file in path.rglob("*") if file.is_file()),
        flaws=flaws if verify else None,
    )


def failures(data, most=20):
    """Return failed cases of a sweep's result, and their number: (list of the first `most`, int).

    Each case is (labels, name of the status, message).  Labels are a dict from dimension to label,
    or to index if labels are missing.
    """
    status = data["status"].values
    cells = np.argwhere((status >= 0) & ~np.isin(status, ANSWERED))
    first = []
    for index in cells[:most]:
        labels = {
            dim: data[dim].values[i] if dim in data.coords else int(i)
            for dim, i in zip(data["status"].dims, index, strict=True)
        }
        at = tuple(index)
        first.append((labels, STATUSES[int(status[at])][0], str(data["message"].values[at])))
    return first, len(cells)
