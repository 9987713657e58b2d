"""A store of a sweep on disk: a Zarr group, filled by chunks, that any interruption leaves whole.

The group holds the result as xarray reads it.  Its subgroup ``sweep`` knows the rest: ``inputs``,
the shape of chunks, versions, and ``done``, one flag a chunk.  A chunk is one file a variable,
written by one task, and reaches the disk before its flag does.  zarr writes a file beside its
place and renames it, so that a file is whole or absent.
"""

import contextlib
import json
import os
import shutil
import tempfile
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray
import zarr
from zarr.codecs import ZstdCodec

from ..dataset import versions
from ..errors import StoreError
from .chunks import Chunks, chunks_of
from .inputs import checksum, differences, inputs_of
from .lock import abandoned, alone, hold

INSIDE = "sweep"
PENDING = -1  # status of a case that has not been done
# Damage is told by a checksum in each file; more effort would hardly make them smaller.
CODEC = ZstdCodec(level=0, checksum=True)


class Store(NamedTuple):
    """An open store."""

    path: Path
    chunks: Chunks
    done: np.ndarray  # (chunks,) bool


def create(path, verb, call, chunks, form):
    """Make a store without results, in a temporary sibling that is renamed when it is whole.

    Raises
    ------
    StoreError
        The place cannot be written to, or has been taken meanwhile.
    """
    try:
        for sibling in path.parent.glob(f".{path.name}.*.partial"):
            if abandoned(sibling):
                shutil.rmtree(sibling, ignore_errors=True)
        temporary = Path(tempfile.mkdtemp(".partial", f".{path.name}.", path.parent))
        handle = hold(temporary)
        try:
            _fill(temporary, verb, call, chunks, form)
            temporary.chmod(0o777 & ~_umask())
            _to_disk(file for file in [temporary, *temporary.rglob("*")])
            temporary.rename(path)
            _to_disk([path.parent])
        finally:
            os.close(handle)
            shutil.rmtree(temporary, ignore_errors=True)
    except OSError as error:
        raise StoreError(
            f"{path} cannot be made ({error.strerror}); give a store that does not exist yet, in "
            f"a folder that does, where you may write and there is room"
        ) from error


def _fill(folder, verb, call, chunks, form):
    """Write all that a new store holds into a folder."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # text and joined metadata are new in Zarr 3
        result = _plain_text(call.dataset(form.static).drop_attrs(deep=False))
        group = zarr.open_group(folder, mode="w", zarr_format=3)
        result.to_zarr(folder, mode="a", consolidated=False, zarr_format=3)
        for name, kind in form.kinds.items():
            if name not in form.static:
                _add(group, name, kind, chunks)
        attributes = call.dataset({}).attrs
        beside = {*result.coords, *({"t"} & form.kinds.keys())} - {*result.dims}
        group.attrs.update(attributes | {"coordinates": " ".join(sorted(beside))})
        inputs = inputs_of(verb, call)
        inside = group.create_group(INSIDE)
        inputs.to_zarr(folder, group=f"{INSIDE}/inputs", consolidated=False, zarr_format=3)
        inside.attrs.update(
            verb=verb,
            sizes=chunks.sizes,
            chunk=list(chunks.shape),
            checksum=checksum(inputs),
            versions=json.loads(versions()),
        )
        inside.create_array(
            "done", shape=(chunks.number,), chunks=(1,), dtype=bool, fill_value=False
        )
        zarr.consolidate_metadata(folder)


def _plain_text(data):
    """The same with labels as text of any length, the one kind that Zarr 3 has settled."""
    texts = [name for name, value in data.coords.items() if value.dtype.kind == "U"]
    return data.assign_coords({name: data[name].astype(object) for name in texts})


def _add(group, name, kind, chunks):
    """An array for a variable, a file a chunk."""
    sizes, shape = chunks.sizes, dict(zip(chunks.sizes, chunks.shape, strict=True))
    text = kind.dtype == object
    fill: Any = PENDING if name == "status" else kind.missing
    group.create_array(
        name,
        shape=[{**sizes, **kind.own}[dim] for dim in kind.dims],
        chunks=[{**shape, **kind.own}[dim] for dim in kind.dims],
        dtype=str if text else kind.dtype,
        fill_value=fill,
        dimension_names=kind.dims,
        attributes={k: v.tolist() if hasattr(v, "tolist") else v for k, v in kind.attrs.items()},
        compressors=[CODEC],
    )


@contextlib.contextmanager
def opened(path, verb, call, chunk):
    """The `Store` at a path, for this sweep and no other at a time.

    Raises
    ------
    StoreError
        It was made by another version or from other parameters, listed; it is no store of a
        sweep, cannot be written to, or is being written to.
    """
    inside, inputs = read(path)
    with alone(path / INSIDE / "zarr.json", path):
        chunks = Chunks(inside.attrs["sizes"], tuple(inside.attrs["chunk"]))
        lines = _versions_differ(inside.attrs["versions"])
        lines += differences(inputs, inputs_of(verb, call))
        if chunk is not None and chunks_of(chunks.sizes, chunk).shape != chunks.shape:
            lines.append(f"chunk: blocks of {chunks.shape} cases in the store, chunk={chunk} now")
        if lines:
            listed = "".join(f"\n  {line}" for line in lines)
            raise StoreError(
                f"{path} holds another sweep; give this one a store of its own, or make it the "
                f"same:{listed}"
            )
        for partial in path.rglob("*.partial"):
            partial.unlink(missing_ok=True)
        yield Store(path, chunks, inside["done"][:])


def read(path):
    """The group with what is known of a sweep, and its inputs; StoreError if that is damaged."""
    try:
        inside: Any = zarr.open_group(path / INSIDE, mode="r", use_consolidated=False)
        with xarray.open_zarr(
            path, group=f"{INSIDE}/inputs", chunks=None, consolidated=False, decode_cf=False
        ) as data:
            inputs = data.load()
        whole = checksum(inputs) == inside.attrs["checksum"] and {"sizes", "chunk", "versions"} <= {
            *inside.attrs
        }
    except PermissionError as error:
        raise StoreError(f"{path} cannot be read ({error.strerror})") from error
    except (OSError, KeyError, ValueError, RuntimeError) as error:
        raise StoreError(
            f"{path} is no store of a sweep, or a damaged one ({error}); give another path"
        ) from error
    if not whole:
        raise StoreError(f"{path}: its record of the parameters is damaged; give another path")
    return inside, inputs


def _versions_differ(stored):
    """Lines for those versions that differ from this process's."""
    here = json.loads(versions())
    return [
        f"version of {name}: {stored.get(name)} made the store, {here.get(name)} is here"
        for name in sorted({*stored, *here})
        if stored.get(name) != here.get(name)
    ]


def write(path, chunks, i, variables):
    """Put the variables of chunk i into the store at a path, and say that they are there.

    Raises
    ------
    StoreError
        They cannot be written, or not whole; the store then lacks them, and nothing else.
    """
    try:
        _write(path, chunks, i, variables)
    except (OSError, KeyError) as error:
        raise StoreError(
            f"{path} cannot be written to ({error}); what it holds is whole: make room, or mend "
            f"what is wrong, and run the same sweep again"
        ) from error


def _write(path, chunks, i, variables):
    group: Any = zarr.open_group(path, mode="r+", zarr_format=3, use_consolidated=False)
    places, index = chunks.places(i), dict(zip(chunks.sizes, chunks.index(i), strict=True))
    files = []
    for name, variable in variables.items():
        # What does not depend on some dimensions is written by the first chunk along them.
        own = [dim for dim in variable.dims if dim in places]
        if own and all(index[dim] == 0 for dim in places if dim not in own):
            array = group[name]
            array[tuple(places.get(dim, slice(None)) for dim in variable.dims)] = variable.values
            key = array.metadata.encode_chunk_key(tuple(index.get(dim, 0) for dim in variable.dims))
            files.append(path / name / key)
    _to_disk(files)
    done = group[f"{INSIDE}/done"]
    done[i] = True
    _to_disk([path / INSIDE / "done" / done.metadata.encode_chunk_key((i,))])


def _to_disk(files):
    """Have the system write these files, and the folders that name them, to the disk itself."""
    files = [file for file in files if file.exists()]  # zarr leaves out files of fill values
    for file in {*files, *(file.parent for file in files)}:
        handle = os.open(file, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def _umask():
    """The mode bits that new files lack."""
    mask = os.umask(0o022)
    os.umask(mask)
    return mask


def result_of(path):
    """The result in a store, read where it is used; cases not done have the status -1."""
    data = xarray.open_zarr(path, chunks=None)
    # xarray cannot mask zarr's own type for text
    return data.assign(message=data["message"].astype(object))
