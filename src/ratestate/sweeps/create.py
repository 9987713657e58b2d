"""Making a store: in a hidden temporary folder beside it, which is renamed when complete."""

import contextlib
import glob
import os
import shutil
import stat
import tempfile
from pathlib import Path
from typing import Any

import zarr
from zarr.codecs import ZstdCodec
from zarr.storage import MemoryStore

from ..errors import StoreError
from . import sentence
from .inputs import checksum, inputs_of
from .legacy import METADATA, SWEEP_GROUP
from .lock import lock_folder, remove_if_abandoned
from .manifest import MANIFEST, RECORDS, keys_in, manifest_entry, sha256
from .origin import origin
from .store import device_attrs, python_text, zarr_3_warnings_ignored
from .writing import FILL_VALUES, NO_RESULT, to_disk

# The checksum in each file reveals damage; a higher level would hardly make files smaller.
CODEC = ZstdCodec(level=0, checksum=True)


def create(path, request, chunks):
    """Make a store without results, in a temporary sibling that is renamed when complete.

    One that another sweep has made there meanwhile is left; StoreError if none can be made.
    """
    try:
        with temporary_sibling(path) as temporary:
            make(temporary, request, chunks)
            # the permissions of an ordinary new folder
            temporary.chmod(stat.S_IMODE((temporary / SWEEP_GROUP).stat().st_mode))
            to_disk([*temporary.rglob("*")], temporary)
            temporary.rename(path)
            to_disk([path], path.parent)
    except OSError as error:
        if path.exists():  # another sweep has made it meanwhile
            return
        raise StoreError(sentence("store.unmade", path=path, error=error.strerror)) from error


@contextlib.contextmanager
def temporary_sibling(path):
    """Context manager: a new folder beside a path (its path), marked as in use, removed in the end.

    OSError if it cannot be made.
    """
    handle = None
    while handle is None:
        temporary = Path(tempfile.mkdtemp(".partial", f".{path.name}.", path.parent))
        handle = lock_folder(temporary)
    try:
        yield temporary
    finally:
        os.close(handle)
        shutil.rmtree(temporary, ignore_errors=True)


def remove_abandoned(path):
    """Remove temporary folders that killed processes left beside a store."""
    for folder in path.parent.glob(f".{glob.escape(path.name)}.*.partial"):
        remove_if_abandoned(folder)


def make(folder, request, chunks):
    """Make a store without results in an empty folder: all its files except those of chunks.

    It is made in memory first, which takes half as long as on disk.
    """
    contents: dict = {}
    memory = MemoryStore(contents)
    with zarr_3_warnings_ignored():
        _write_static(memory, request, chunks)
        made_by = origin(request.device)
        _write_sweep_group(memory, contents, request, chunks, made_by["versions"])
        zarr.consolidate_metadata(memory)
        _write_files(folder, contents)
        manifest: Any = zarr.open_array(folder / MANIFEST, mode="r+", zarr_format=3)
        manifest[chunks.number] = manifest_entry(folder, keys_in(folder), None, made_by)


def _write_files(folder, contents):
    """Write these contents into a folder: key -> zarr's buffer."""
    for key, content in contents.items():
        (folder / key).parent.mkdir(parents=True, exist_ok=True)
        (folder / key).write_bytes(content.as_buffer_like())


def _write_static(store, request, chunks):
    """Write what is known of the result before it is computed, and arrays for the rest."""
    call, form = request.call, request.form
    result = python_text(call.dataset(form.static).drop_attrs(deep=False))
    group = zarr.open_group(store, mode="a", zarr_format=3)
    encoding: dict = {name: {"compressors": [CODEC]} for name in result.variables}
    for name, variable in result.variables.items():
        if variable.dtype.kind == "f":
            encoding[name] |= {"fill_value": NO_RESULT, "_FillValue": None}
    result.to_zarr(store, mode="a", consolidated=False, zarr_format=3, encoding=encoding)
    for name, spec in form.specs.items():
        if name not in form.static:
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


def _write_sweep_group(store, contents, request, chunks, versions):
    """Write the inputs of the sweep, and that no chunk is done.

    contents : those of the store, key -> zarr's buffer
    """
    inputs = inputs_of(request.name, request.call)
    sweep_group = zarr.open_group(store, mode="r+", zarr_format=3).create_group(SWEEP_GROUP)
    inputs.to_zarr(store, group=f"{SWEEP_GROUP}/inputs", consolidated=False, zarr_format=3)
    add_record(sweep_group, "done", bool, chunks.number)
    add_record(sweep_group, "manifest", str, chunks.number + 1)
    records = [f"{SWEEP_GROUP}/{name}/{METADATA}" for name in ("done", "manifest")]
    sweep_group.attrs.update(
        {
            "verb": request.name,
            "sizes": chunks.sizes,
            "chunk": list(chunks.shape),
            "device": request.device,
            "checksum": checksum(inputs),
            "versions": versions,
            RECORDS: {key: sha256(contents[key].to_bytes()) for key in records},
        }
    )


def add_record(sweep_group, name, kind, number):
    """Add a 1-D array with a file for each value to the group ``sweep``, filled with False or "".

    kind : bool or str; number : of values
    """
    sweep_group.create_array(
        name, shape=(number,), chunks=(1,), dtype=kind, fill_value=kind(), compressors=[CODEC]
    )
