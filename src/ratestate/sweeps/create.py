"""Making a store: in a hidden folder beside its place, renamed when it is whole."""

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
from .lock import hold, remove_if_abandoned
from .manifest import MANIFEST, RECORDS, entry, sha256
from .older import INSIDE, METADATA
from .origin import origin
from .store import NO_RESULT, noted, to_disk

PENDING = -1  # status of a case that has not been done, and no result in other integers
# Damage is told by a checksum in each file; more effort would hardly make them smaller.
CODEC = ZstdCodec(level=0, checksum=True)


def create(path, verb, call, chunks, form, device):
    """Make a store without results, in a temporary sibling that is renamed when it is whole.

    Raises
    ------
    StoreError
        The place cannot be written to, or has been taken meanwhile.
    """
    try:
        temporary, handle = sibling(path)
        try:
            make(temporary, verb, call, chunks, form, device)
            # as folders are made here
            temporary.chmod(stat.S_IMODE((temporary / INSIDE).stat().st_mode))
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


def sibling(path):
    """A temporary folder beside a path, and the handle that marks it as in use."""
    while True:
        temporary = Path(tempfile.mkdtemp(".partial", f".{path.name}.", path.parent))
        handle = hold(temporary)
        if handle is not None:
            return temporary, handle


def tidy(path):
    """Remove what killed processes left beside a store."""
    for sibling in path.parent.glob(f".{glob.escape(path.name)}.*.partial"):
        remove_if_abandoned(sibling)


def make(folder, verb, call, chunks, form, device):
    """Make a store in a folder: all its files, but for those of chunks."""
    _fill(folder, call, chunks, form, device)
    _note(folder, verb, call, chunks, device)
    _list(folder, chunks, device)


def _fill(folder, call, chunks, form, device):
    """Write the result into a folder, as far as it is known, with room for the rest."""
    with _unsettled():
        result = _plain_text(call.dataset(form.static).drop_attrs(deep=False))
        group = zarr.open_group(folder, mode="a", zarr_format=3)
        sure: dict = {name: {"compressors": [CODEC]} for name in result.variables}
        for name, variable in result.variables.items():
            if variable.dtype.kind == "f":
                sure[name] |= {"fill_value": NO_RESULT, "_FillValue": None}
        result.to_zarr(folder, mode="a", consolidated=False, zarr_format=3, encoding=sure)
        for name, kind in form.kinds.items():
            if name not in form.static:
                _add(group, name, kind, chunks)
        attributes = call.dataset({}).attrs | noted(device)
        beside = {*result.coords, *({"t"} & form.kinds.keys())} - {*result.dims}
        group.attrs.update(attributes | {"coordinates": " ".join(sorted(beside))})


def _note(folder, verb, call, chunks, device):
    """Write into the folder what the sweep is asked, and that no chunk is done."""
    with _unsettled():
        inputs = inputs_of(verb, call)
        inside = zarr.open_group(folder, mode="r+", zarr_format=3).create_group(INSIDE)
        inputs.to_zarr(folder, group=f"{INSIDE}/inputs", consolidated=False, zarr_format=3)
        add_record(inside, "done", bool, chunks.number)
        add_record(inside, "manifest", str, chunks.number + 1)
        records = [folder / INSIDE / name / METADATA for name in ("done", "manifest")]
        inside.attrs.update(
            verb=verb,
            sizes=chunks.sizes,
            chunk=list(chunks.shape),
            device=device,
            checksum=checksum(inputs),
            versions=json.loads(versions()),
            **{
                RECORDS: {
                    f"{file.relative_to(folder)}": sha256(file.read_bytes()) for file in records
                }
            },
        )
        zarr.consolidate_metadata(folder)


def add_record(inside, name, kind, number):
    """Add an array of one dimension, a file for each value, to the group ``sweep``."""
    with _unsettled():
        inside.create_array(
            name,
            shape=(number,),
            chunks=(1,),
            dtype=kind,
            fill_value=kind(),
            compressors=[CODEC],
        )


def _list(folder, chunks, device):
    """Write into the manifest what all other files in the folder hold."""
    keys = [file.relative_to(folder).as_posix() for file in folder.rglob("*") if file.is_file()]
    with _unsettled():
        manifest: Any = zarr.open_array(folder / MANIFEST, mode="r+")
        manifest[chunks.number] = entry(folder, keys, None, origin(device))


@contextlib.contextmanager
def _unsettled():
    """Use what is new in Zarr 3, and all its readers know: text, and metadata joined in a file."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        yield


def _plain_text(data):
    """The same with labels as text of any length, the one kind that Zarr 3 has settled."""
    texts = [name for name, value in data.coords.items() if value.dtype.kind == "U"]
    return data.assign_coords({name: data[name].astype(object) for name in texts})


def _add(group, name, kind, chunks):
    """An array for a variable, a file a chunk."""
    sizes, shape = chunks.sizes, dict(zip(chunks.sizes, chunks.shape, strict=True))
    text = kind.dtype == object
    group.create_array(
        name,
        shape=[{**sizes, **kind.own}[dim] for dim in kind.dims],
        chunks=[{**shape, **kind.own}[dim] for dim in kind.dims],
        dtype=str if text else kind.dtype,
        fill_value=_absent(kind),
        dimension_names=kind.dims,
        attributes={k: v.tolist() if hasattr(v, "tolist") else v for k, v in kind.attrs.items()},
        compressors=[CODEC],
    )


def _absent(kind: Any) -> Any:
    """What is read where a file is not there: where there is one, a value that no result has."""
    match kind.dtype.kind:
        case "f":
            return NO_RESULT
        case "c":
            return complex(NO_RESULT, NO_RESULT)
        case "i":
            return PENDING
        case _:
            return kind.missing
