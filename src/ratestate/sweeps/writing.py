"""Create a store, write its chunks, and lock it against other sweeps.

The module `store` says what is written in which order.
"""

import contextlib
import fcntl
import os
import shutil
import warnings
from typing import Any

import zarr
from zarr.codecs import ZstdCodec
from zarr.storage import MemoryStore

from ..errors import StoreError
from . import sentence
from .store import (
    FILL_VALUES,
    METADATA,
    NO_RESULT,
    SWEEP_GROUP,
    Store,
    device_attrs,
    key_of,
    python_text,
    zarr_3_warnings_ignored,
)

# The checksum in each file reveals damage; a higher level would hardly make files smaller.
CODEC = ZstdCodec(level=0, checksum=True)


@contextlib.contextmanager
def exclusive_lock(file, path, flags=0):
    """Lock a file of the store at a path; the system unlocks it if the process is killed.

    StoreError if another sweep has the lock, or the file cannot be opened with these flags.
    """
    try:
        handle = os.open(file, os.O_RDWR | flags)
    except OSError as error:
        message = sentence("store.unwritable", path=path, error=error.strerror)
        raise StoreError(message) from error
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise StoreError(sentence("store.in_use", path=path)) from None
        except OSError as error:  # some network file systems have no locks
            message = sentence("store.no_lock", path=path, error=error.strerror)
            warnings.warn(message, RuntimeWarning, stacklevel=4)
        yield
    finally:
        os.close(handle)


# A store is made ----------------------------------------------------------------------------------


def create(path, request, chunks):
    """Make a store without results, unless another sweep has made one there meanwhile."""
    partial = path.with_name(f".{path.name}.partial")
    try:
        partial.mkdir(exist_ok=True)
        with exclusive_lock(partial / METADATA, path, os.O_CREAT):
            _clear(partial)  # of what a sweep left that was killed
            try:
                if not path.exists():
                    for key, content in _contents(request, chunks).items():
                        (partial / key).parent.mkdir(parents=True, exist_ok=True)
                        (partial / key).write_bytes(content)
                    _sync(partial, [*partial.rglob("*")])
                    partial.rename(path)
                    _sync(path.parent, [path])
            finally:
                with contextlib.suppress(FileNotFoundError):
                    _clear(partial)
                    (partial / METADATA).unlink()  # last, since it is locked
                    partial.rmdir()
    except StoreError:
        raise
    except OSError as error:
        raise StoreError(sentence("store.unmade", path=path, error=error.strerror)) from error


def _clear(folder):
    for path in folder.iterdir():
        if path.is_dir():
            shutil.rmtree(path)


def _contents(request, chunks):
    files: dict = {}
    memory = MemoryStore(files)
    with zarr_3_warnings_ignored():
        _add_result(memory, request, chunks)
        group = zarr.open_group(memory, mode="r+", zarr_format=3).create_group(SWEEP_GROUP)
        group.attrs.update(request.record(chunks))
        zarr.consolidate_metadata(memory)
    return {key: buffer.to_bytes() for key, buffer in files.items()}


def _add_result(memory, request, chunks):
    """Add what is known of the result before it is computed, and arrays for the rest."""
    call, form = request.call, request.form
    result = python_text(call.dataset(form.static).drop_attrs(deep=False))
    group = zarr.open_group(memory, mode="a", zarr_format=3)
    encoding: dict = {name: {"compressors": [CODEC]} for name in result.variables}
    for name, variable in result.variables.items():
        if variable.dtype.kind == "f":
            encoding[name] |= {"fill_value": NO_RESULT, "_FillValue": None}
    # (without empty chunks a missing file could not be told from one of zeros)
    options = {"mode": "a", "consolidated": False, "zarr_format": 3, "write_empty_chunks": True}
    result.to_zarr(memory, encoding=encoding, **options)
    sizes, shape = chunks.sizes, dict(zip(chunks.sizes, chunks.shape, strict=True))
    for name, spec in form.swept.items():
        attrs = {k: v.tolist() if hasattr(v, "tolist") else v for k, v in spec.attrs.items()}
        group.create_array(
            name,
            shape=tuple({**sizes, **spec.sizes}[dim] for dim in spec.dims),
            chunks=tuple({**shape, **spec.sizes}[dim] for dim in spec.dims),
            dtype=str if spec.dtype == object else spec.dtype,
            fill_value=FILL_VALUES.get(spec.dtype.kind, spec.missing),
            dimension_names=spec.dims,
            attributes=attrs,
            compressors=[CODEC],
        )
    attributes = call.dataset({}).attrs | device_attrs(request.device)
    coordinates = {*result.coords, *({"t"} & form.specs.keys())} - {*result.dims}
    group.attrs.update(attributes | {"coordinates": " ".join(sorted(coordinates))})


# Chunks are written -------------------------------------------------------------------------------


def write(store, i, variables):
    """Write the variables of chunk i into a `Store`, ``status`` last; StoreError if that fails."""
    path = store.path
    try:
        present = Store.open(path)
        if present.record != store.record:  # a worker may not have noticed
            raise StoreError(sentence("store.replaced", path=path))
        group: Any = zarr.open_group(path, mode="r+", zarr_format=3, use_consolidated=True)
        blocks = present.chunks.blocks(i, present.dims)
        for names in (blocks.keys() - {"status"}, ["status"]):
            for name in names:
                # (zarr omits files that hold only fill values; here a missing file means a loss)
                array = group[name].with_config({"write_empty_chunks": True})
                array.blocks[blocks[name]] = variables[name].values
            _sync(path, [path / key_of(name, blocks[name]) for name in names])
    except StoreError:
        raise
    except (FileNotFoundError, KeyError) as error:
        raise StoreError(sentence("store.vanished", path=path)) from error
    except OSError as error:
        raise StoreError(sentence("store.full", path=path, error=error)) from error


def _sync(top, files):
    """Have the system write files, and their folders up to `top`, to the disk."""
    folders = {folder for file in files for folder in file.parents if folder.is_relative_to(top)}
    for file in {*files, *folders}:
        handle = os.open(file, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
