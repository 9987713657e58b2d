"""What a store, or a result, holds."""

import json
import math
from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import zarr

from ..engine.model import CRASHED, STATUSES, STEADY_SLIDING
from .manifest import Checked, contents, flaws, whole
from .solve import ANSWERED
from .store import chunks_in, damage_told, read


class Held(NamedTuple):
    """What a store holds."""

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
    flaws: list | None  # texts: files that are damaged or missing; None: not looked for


def held(path, verify=False):
    """What the store at a path holds; `Held`.

    Parameters
    ----------
    path : str or Path
    verify : bool
        Whether to read all files, and hold them against the store's manifest.

    Raises
    ------
    StoreError
        It is no store of a sweep, or cannot be read.
    """
    path = Path(path)
    inside, _ = read(path)
    chunks = chunks_in(inside)
    with damage_told(path):
        there = contents(path, inside)
        found = flaws(there) if verify else []
        done = whole(there, found)
        number = _counts(Checked(path, held=there), chunks, done)
    return Held(
        path,
        inside.attrs["verb"],
        chunks.sizes,
        math.prod(chunks.sizes.values()),
        number.total(),
        _failed(number),
        number[STEADY_SLIDING],
        chunks.number,
        int(done.sum()),
        inside.attrs["versions"],
        sum(file.stat().st_size for file in path.rglob("*") if file.is_file()),
        _origins(inside, there, done),
        list(map(str, found)) if verify else None,
    )


def _origins(inside, there, done):
    """What made the chunks that are done, and how many each."""
    number = Counter[str]()
    for i in np.flatnonzero(done).tolist():
        entry = there.entries.get(i, inside.attrs)
        who = {"versions": entry["versions"], "processor": entry.get("processor")}
        number[json.dumps(who, sort_keys=True)] += 1
    return [json.loads(who) | {"chunks": n} for who, n in number.items()]


def failed_in(store):
    """Number of failed cases among those that an open `Store` has."""
    with damage_told(store.path):
        return _failed(_counts(store.path, store.chunks, store.done))


def crashed_in(store):
    """Numbers of the chunks with cases that crashed, among those that an open `Store` has."""
    with damage_told(store.path):
        parts = _statuses(store.path, store.chunks, store.done)
        return [i for i, status in parts if (status == CRASHED).any()]


def _counts(path, chunks, done):
    """Status -> number of cases, of the chunks that are done."""
    number = Counter[int]()
    for _, status in _statuses(path, chunks, done):
        codes, counts = np.unique(status, return_counts=True)
        number.update(dict(zip(codes.tolist(), counts.tolist(), strict=True)))
    return number


def _statuses(path, chunks, done):
    """(number, status of its cases) of each chunk that is done."""
    status: Any = zarr.open_group(path, mode="r", use_consolidated=False)["status"]
    for i in np.flatnonzero(done).tolist():
        yield i, status[tuple(chunks.places(i).values())]


def _failed(number):
    return sum(count for code, count in number.items() if code not in ANSWERED)


def failures(data, most=20):
    """The first failed cases of a sweep's result.

    Parameters
    ----------
    data : Dataset
        With ``status`` and ``message``.
    most : int

    Returns
    -------
    list of (place, name, message), int
        Place: dimension -> label, or number where it has none; name of the status; and of how many
        they are the first.
    """
    status = data["status"].values
    where = np.argwhere((status >= 0) & ~np.isin(status, ANSWERED))
    found = []
    for index in where[:most]:
        place = {
            dim: data[dim].values[i] if dim in data.coords else int(i)
            for dim, i in zip(data["status"].dims, index, strict=True)
        }
        at = tuple(index)
        found.append((place, STATUSES[int(status[at])][0], str(data["message"].values[at])))
    return found, len(where)
