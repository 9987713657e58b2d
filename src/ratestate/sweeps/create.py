"""Making a store: in a hidden temporary folder beside it, which is renamed when complete."""

import contextlib
import glob
import json
import os
import shutil
import stat
import tempfile
import warnings
from pathlib import Path
from typing import Any

import zarr
from zarr.codecs import ZstdCodec

from ..dynamics.results import versions
from ..errors import StoreError
from .inputs import checksum, inputs_of
from .legacy import METADATA, SWEEP_GROUP
from .lock import lock_folder, remove_if_abandoned
from .manifest import MANIFEST, RECORDS, manifest_entry, sha256
from .origin import origin
from .store import NO_RESULT, device_attrs, to_disk

PENDING = -1  # status of a case that has not been done; other integers of such a case, too
# The checksum in each file reveals damage; a higher level would hardly make files smaller.
CODEC = ZstdCodec(level=0, checksum=True)


def create(path, request, chunks, form):
    """Make a store without results, in a temporary sibling that is renamed when complete.

    Raises
    ------
    StoreError
        The folder cannot be written to.
    """
    try:
        temporary, handle = temporary_sibling(path)
        try:
            make(temporary, request, chunks, form)
            # the permissions of an ordinary new folder
            temporary.chmod(stat.S_IMODE((temporary / SWEEP_GROUP).stat().st_mode))
            to_disk([*temporary.rglob("*")], temporary)
            temporary.rename(path)
            to_disk([path], path.parent)
        finally:
            os.close(handle)
            shutil.rmtree(temporary, ignore_errors=True)
    except OSError as error:
        if path.exists():  # another sweep has made it meanwhile
            return
        raise StoreError(
            f"{path} cannot be made ({error.strerror}); give a store that does not exist yet, in "
            f"a folder that does, where you may write and there is room"
        ) from error


def temporary_sibling(path):
    """Make a temporary folder beside a path; it, and the handle that marks it as in use."""
    while True:
        temporary = Path(tempfile.mkdtemp(".partial", f".{path.name}.", path.parent))
        handle = lock_folder(temporary)
        if handle is not None:
            return temporary, handle


def remove_abandoned(path):
    """Remove temporary folders that killed processes left beside a store."""
    for folder in path.parent.glob(f".{glob.escape(path.name)}.*.partial"):
        remove_if_abandoned(folder)


def make(folder, request, chunks, form):
    """Make a store without results in a folder: all its files except those of chunks."""
    _write_static(folder, request, chunks, form)
    _write_inputs(folder, request, chunks)
    _write_manifest(folder, chunks, request.device)


def _write_static(folder, request, chunks, form):
    """Write what is known of the result before it is computed, and arrays for the rest."""
    call = request.call
    with _zarr_3_warnings_ignored():
        result = _object_strings(call.dataset(form.static).drop_attrs(deep=False))
        group = zarr.open_group(folder, mode="a", zarr_format=3)
        encoding: dict = {name: {"compressors": [CODEC]} for name in result.variables}
        for name, variable in result.variables.items():
            if variable.dtype.kind == "f":
                encoding[name] |= {"fill_value": NO_RESULT, "_FillValue": None}
        result.to_zarr(folder, mode="a", consolidated=False, zarr_format=3, encoding=encoding)
        for name, spec in form.specs.items():
            if name not in form.static:
                _add_variable(group, name, spec, chunks)
        attributes = call.dataset({}).attrs | device_attrs(request.device)
        coordinates = {*result.coords, *({"t"} & form.specs.keys())} - {*result.dims}
        group.attrs.update(attributes | {"coordinates": " ".join(sorted(coordinates))})


def _write_inputs(folder, request, chunks):
    """Write the inputs of the sweep, and that no chunk is done."""
    with _zarr_3_warnings_ignored():
        inputs = inputs_of(request.name, request.call)
        sweep_group = zarr.open_group(folder, mode="r+", zarr_format=3).create_group(SWEEP_GROUP)
        inputs.to_zarr(folder, group=f"{SWEEP_GROUP}/inputs", consolidated=False, zarr_format=3)
        add_record(sweep_group, "done", bool, chunks.number)
        add_record(sweep_group, "manifest", str, chunks.number + 1)
        records = [folder / SWEEP_GROUP / name / METADATA for name in ("done", "manifest")]
        sweep_group.attrs.update(
            verb=request.name,
            sizes=chunks.sizes,
            chunk=list(chunks.shape),
            device=request.device,
            checksum=checksum(inputs),
            versions=json.loads(versions()),
            **{
                RECORDS: {
                    str(file.relative_to(folder)): sha256(file.read_bytes()) for file in records
                }
            },
        )
        zarr.consolidate_metadata(folder)


def add_record(sweep_group, name, spec, number):
    """Add a 1-D array with a file for each value to the group ``sweep``."""
    with _zarr_3_warnings_ignored():
        sweep_group.create_array(
            name,
            shape=(number,),
            chunks=(1,),
            dtype=spec,
            fill_value=spec(),
            compressors=[CODEC],
        )


def _write_manifest(folder, chunks, device):
    """Write the entry for all files in the folder into the manifest."""
    keys = [file.relative_to(folder).as_posix() for file in folder.rglob("*") if file.is_file()]
    with _zarr_3_warnings_ignored():
        manifest: Any = zarr.open_array(folder / MANIFEST, mode="r+")
        manifest[chunks.number] = manifest_entry(folder, keys, None, origin(device))


@contextlib.contextmanager
def _zarr_3_warnings_ignored():
    """Allow strings and consolidated metadata: zarr warns, but all readers of Zarr 3 know them."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        yield


def _object_strings(data):
    """Convert string labels to variable-length strings, the only ones that Zarr 3 specifies."""
    texts = [name for name, value in data.coords.items() if value.dtype.kind == "U"]
    return data.assign_coords({name: data[name].astype(object) for name in texts})


def _add_variable(group, name, spec, chunks):
    """Add the array of a variable, with a file for each chunk."""
    sizes, shape = chunks.sizes, dict(zip(chunks.sizes, chunks.shape, strict=True))
    text = spec.dtype == object
    group.create_array(
        name,
        shape=[{**sizes, **spec.own}[dim] for dim in spec.dims],
        chunks=[{**shape, **spec.own}[dim] for dim in spec.dims],
        dtype=str if text else spec.dtype,
        fill_value=_fill_value(spec),
        dimension_names=spec.dims,
        attributes={k: v.tolist() if hasattr(v, "tolist") else v for k, v in spec.attrs.items()},
        compressors=[CODEC],
    )


def _fill_value(spec: Any) -> Any:
    """The value that is read where a file is absent: one that no result has, if there is such."""
    match spec.dtype.kind:
        case "f":
            return NO_RESULT
        case "c":
            return complex(NO_RESULT, NO_RESULT)
        case "i":
            return PENDING
        case _:
            return spec.missing
