"""The status of a store: cases done, failed cases, versions, damage."""

import json
import math
from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import zarr

from ..engine.model import CRASHED, STATUSES, STEADY_SLIDING
from .manifest import Checked
from .solve import ANSWERED
from .store import as_store_error, read_record


class StoreStatus(NamedTuple):
    """How much of a sweep a store has, and what made it."""

    path: Path
    verb: str
    dims: dict  # dimension -> number of values
    cases: int
    done: int  # cases
    failed: int  # of those done: neither finished nor steady sliding
    steady: int  # of those done, that slide steadily
    chunks: int
    chunks_done: int
    versions: dict  # of the programs that made it
    size: int  # bytes on disk
    origins: list  # dicts: versions, processor (None: not recorded) and number of chunks of each
    flaws: list | None  # strings: files that are damaged or missing; None: not verified


def store_status(path, verify=False):
    """`StoreStatus` of the store at a path; StoreError if there is none, or it cannot be read.

    verify : read all files and compare checksums; chunks with flaws then count as not done
    """
    path = Path(path)
    record, _ = read_record(path)
    chunks, attrs = record.chunks, record.attrs
    with as_store_error(path):
        flaws = record.flaws if verify else []
        done = record.intact(flaws)
        statuses = _statuses(Checked(path, files=record.files), chunks, done)
    counts = sum(statuses.values(), Counter[int]())
    return StoreStatus(
        path=path,
        verb=attrs["verb"],
        dims=chunks.sizes,
        cases=math.prod(chunks.sizes.values()),
        done=counts.total(),
        failed=_failed(counts),
        steady=counts[STEADY_SLIDING],
        chunks=chunks.number,
        chunks_done=len(statuses),
        versions=attrs["versions"],
        size=sum(file.stat().st_size for file in path.rglob("*") if file.is_file()),
        origins=_origins([record.entries.get(i, attrs) for i in statuses]),
        flaws=list(map(str, flaws)) if verify else None,
    )


def _origins(entries):
    """The origins in entries of chunks, each with the number of its chunks."""
    counts = Counter[str]()
    for entry in entries:
        origin = {"versions": entry["versions"], "processor": entry.get("processor")}
        counts[json.dumps(origin, sort_keys=True)] += 1
    return [json.loads(origin) | {"chunks": n} for origin, n in counts.items()]


def failed_cases_in(store):
    """Number of cases neither finished nor steady sliding in the chunks that a `Store` has done."""
    with as_store_error(store.path):
        return sum(map(_failed, _statuses(store.path, store.chunks, store.done).values()))


def crashed_chunks_in(store):
    """List of numbers of the chunks with cases that crashed, of those that a `Store` has done."""
    with as_store_error(store.path):
        statuses = _statuses(store.path, store.chunks, store.done)
    return [i for i, counts in statuses.items() if counts[CRASHED]]


def _statuses(source, chunks, done):
    """Chunk -> `Counter` of the statuses of its cases, for those that are done."""
    group: Any = zarr.open_group(source, mode="r", zarr_format=3, use_consolidated=False)
    status = group["status"]
    statuses: dict[int, Counter[int]] = {}
    for i in np.flatnonzero(done).tolist():
        found = np.unique(status[tuple(chunks.slices(i).values())], return_counts=True)
        statuses[i] = Counter(dict(zip(*(part.tolist() for part in found), strict=True)))
    return statuses


def _failed(counts):
    return sum(count for code, count in counts.items() if code not in ANSWERED)


def failures(data, most=20):
    """Failed cases of a sweep's result, and their number: (list of the first `most`, int).

    Failed: neither finished nor steady sliding; cases not yet computed (-1) do not count.  Each is
    (labels, name of the status, message); labels: dimension -> label, or index where there is no
    label.
    """
    status = data["status"].values
    where = np.argwhere((status >= 0) & ~np.isin(status, ANSWERED))
    first = []
    for index in where[:most]:
        labels = {
            dim: data[dim].values[i] if dim in data.coords else int(i)
            for dim, i in zip(data["status"].dims, index, strict=True)
        }
        at = tuple(index)
        first.append((labels, STATUSES[int(status[at])][0], str(data["message"].values[at])))
    return first, len(where)
