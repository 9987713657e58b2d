"""The status of a store: cases done, failed cases, versions, damage."""

import json
import math
from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import zarr

from ..engine.model import CRASHED, STATUSES, STEADY_SLIDING
from .manifest import Checked, find_flaws, intact_chunks, read_contents
from .solve import ANSWERED
from .store import as_store_error, read_group, stored_chunks


class StoreStatus(NamedTuple):
    """How much of a sweep a store has, and what made it."""

    path: Path
    verb: str
    dims: dict  # dimension -> number of values
    cases: int
    done: int  # cases
    failed: int
    steady: int  # that slide steadily
    chunks: int
    chunks_done: int
    versions: dict  # of the programs that made it
    size: int  # bytes on disk
    origins: list  # dicts: versions, processor (None: not recorded) and number of chunks of each
    flaws: list | None  # strings: files that are damaged or missing; None: not verified


def store_status(path, verify=False):
    """`StoreStatus` of the store at a path.

    Parameters
    ----------
    path : str or Path
    verify : bool
        Whether to read all files and compare them with the store's manifest.

    Raises
    ------
    StoreError
        It is no store of a sweep, or cannot be read.
    """
    path = Path(path)
    sweep_group, _ = read_group(path)
    chunks = stored_chunks(sweep_group)
    with as_store_error(path):
        contents = read_contents(path, sweep_group)
        flaws = find_flaws(contents) if verify else []
        done = intact_chunks(contents, flaws)
        counts = _count_statuses(Checked(path, contents=contents), chunks, done)
    return StoreStatus(
        path,
        sweep_group.attrs["verb"],
        chunks.sizes,
        math.prod(chunks.sizes.values()),
        counts.total(),
        _count_failed(counts),
        counts[STEADY_SLIDING],
        chunks.number,
        int(done.sum()),
        sweep_group.attrs["versions"],
        sum(file.stat().st_size for file in path.rglob("*") if file.is_file()),
        _origins(sweep_group, contents, done),
        list(map(str, flaws)) if verify else None,
    )


def _origins(sweep_group, contents, done):
    """The origins of the chunks that are done, each with the number of its chunks."""
    counts = Counter[str]()
    for i in np.flatnonzero(done).tolist():
        made = contents.entries.get(i, sweep_group.attrs)
        origin = {"versions": made["versions"], "processor": made.get("processor")}
        counts[json.dumps(origin, sort_keys=True)] += 1
    return [json.loads(origin) | {"chunks": n} for origin, n in counts.items()]


def failed_cases_in(store):
    """Number of failed cases among those that an open `Store` has."""
    with as_store_error(store.path):
        return _count_failed(_count_statuses(store.path, store.chunks, store.done))


def crashed_chunks_in(store):
    """Numbers of the chunks with cases that crashed, among those that an open `Store` has."""
    with as_store_error(store.path):
        parts = _statuses(store.path, store.chunks, store.done)
        return [i for i, status in parts if (status == CRASHED).any()]


def _count_statuses(path, chunks, done):
    """Status -> number of cases, of the chunks that are done."""
    counts = Counter[int]()
    for _, status in _statuses(path, chunks, done):
        codes, numbers = np.unique(status, return_counts=True)
        counts.update(dict(zip(codes.tolist(), numbers.tolist(), strict=True)))
    return counts


def _statuses(path, chunks, done):
    """Yield (number, status of its cases) for each chunk that is done."""
    status: Any = zarr.open_group(path, mode="r", use_consolidated=False)["status"]
    for i in np.flatnonzero(done).tolist():
        yield i, status[tuple(chunks.slices(i).values())]


def _count_failed(counts):
    return sum(count for code, count in counts.items() if code not in ANSWERED)


def failures(data, most=20):
    """The first failed cases of a sweep's result.

    Parameters
    ----------
    data : Dataset
        With ``status`` and ``message``.
    most : int

    Returns
    -------
    list of (labels, name, message)
        Labels: dimension -> label, or index where there is no label.  Name of the status.
    int
        Number of all failed cases.
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
