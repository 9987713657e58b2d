"""Writing a store: it is made, its chunks are written, and a lock keeps other sweeps away.

The module `store` says what is written in which order.
"""

import contextlib
import fcntl
import os
import shutil
import uuid
import warnings
from pathlib import Path

import zarr
from zarr.codecs import ZstdCodec
from zarr.core.buffer import default_buffer_prototype
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

    StoreError if another sweep has the lock, or the file is missing or cannot be written to.

    flags : for opening the file, beside those for reading and writing
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
    """Make a store without results; StoreError if that is not possible.

    If another sweep has made one there meanwhile, it stays as it is.
    """
    partial = path.with_name(f".{path.name}.partial")
    try:
        partial.mkdir(exist_ok=True)
        with exclusive_lock(partial / METADATA, path, os.O_CREAT):
            _clear(partial)  # of what a sweep left that was killed
            try:
                if not path.exists():
                    _fill(partial, _contents(request, chunks))
                    partial.rename(path)
                    _sync([path.parent])
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
    """Remove the folders in a folder."""
    for one in folder.iterdir():
        if one.is_dir():
            shutil.rmtree(one)


def _fill(folder, contents):
    """Write files into a folder, and have the system write them to the disk: key -> bytes."""
    for key, content in contents.items():
        (folder / key).parent.mkdir(parents=True, exist_ok=True)
        _write_file(folder / key, content)
    _sync([folder, *(one for one in folder.rglob("*") if one.is_dir())])


def _contents(request, chunks):
    """Return the files of a store without results: key -> bytes."""
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
    how = {"mode": "a", "consolidated": False, "zarr_format": 3, "write_empty_chunks": True}
    result.to_zarr(memory, encoding=encoding, **how)
    for name, spec in form.swept.items():
        _add_variable(group, name, spec, chunks)
    attributes = call.dataset({}).attrs | device_attrs(request.device)
    coordinates = {*result.coords, *({"t"} & form.specs.keys())} - {*result.dims}
    group.attrs.update(attributes | {"coordinates": " ".join(sorted(coordinates))})


def _add_variable(group, name, spec, chunks):
    """Add the array of a variable, with a file for each chunk."""
    sizes, shape = chunks.sizes, dict(zip(chunks.sizes, chunks.shape, strict=True))
    group.create_array(
        name,
        shape=[{**sizes, **spec.own}[dim] for dim in spec.dims],
        chunks=[{**shape, **spec.own}[dim] for dim in spec.dims],
        dtype=str if spec.dtype == object else spec.dtype,
        fill_value=FILL_VALUES.get(spec.dtype.kind, spec.missing),
        dimension_names=spec.dims,
        attributes={k: v.tolist() if hasattr(v, "tolist") else v for k, v in spec.attrs.items()},
        compressors=[CODEC],
    )


# Chunks are written -------------------------------------------------------------------------------


def write(store, i, variables):
    """Write the variables of chunk i into a `Store`, ``status`` last.

    If that fails (StoreError) the store lacks this chunk, and nothing else.
    """
    path = store.path
    with _write_errors(path):
        present = Store.open(path)
        if present.record != store.record:  # a worker may not have noticed
            raise StoreError(sentence("store.replaced", path=path))
        blocks = present.chunks.blocks(i, present.dims)
        for names in (blocks.keys() - {"status"}, ["status"]):
            folders = set()
            for name in names:
                content = _encoded(present.arrays[name], blocks[name], variables[name].values)
                folders |= _put(path, key_of(name, blocks[name]), content)
            _sync(folders)


def _encoded(array, block, values):
    """Return the content (bytes) of the file with a block of a zarr array."""
    contents = array.metadata.to_buffer_dict(default_buffer_prototype())
    copy = zarr.open_array(MemoryStore(contents), mode="r+", zarr_format=3)
    copy.with_config({"write_empty_chunks": True}).blocks[block] = values
    (content,) = (buffer.to_bytes() for key, buffer in contents.items() if key != METADATA)
    return content


def _put(path, key, content):
    """Write a file of the store at a path; return the folders that it is in.

    The folder of its variable must exist: a store that is gone is not made again.
    """
    file, *_, variable, _ = (path / one for one in (key, *Path(key).parents))
    folders = {one for one in file.parents if variable in (one, *one.parents)}
    for folder in sorted(folders - {variable}):
        folder.mkdir(exist_ok=True)
    partial = file.with_name(f"{file.name}.{uuid.uuid4().hex}.partial")
    try:
        _write_file(partial, content)
        partial.replace(file)
    finally:
        partial.unlink(missing_ok=True)
    return folders


def mark_undone(store, numbers):
    """Have the chunks with these numbers computed again; StoreError if that cannot be written."""
    with _write_errors(store.path):
        for i in numbers:
            store.mark(i).unlink()
        _sync({store.mark(i).parent for i in numbers})


@contextlib.contextmanager
def _write_errors(path):
    """Turn any error from writing into a StoreError."""
    try:
        yield
    except StoreError:
        raise
    except FileNotFoundError as error:
        raise StoreError(sentence("store.vanished", path=path)) from error
    except OSError as error:
        raise StoreError(sentence("store.full", path=path, error=error)) from error


def _write_file(file, content):
    """Write bytes to a file, and have the system write them to the disk."""
    with file.open("wb") as handle:
        handle.write(content)
        handle.flush()
        os.fsync(handle.fileno())


def _sync(folders):
    """Have the system write the entries of folders to the disk."""
    for folder in folders:
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
