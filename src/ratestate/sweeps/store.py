"""A store of a sweep on disk, a Zarr group: what it says of itself, and its result.

The group holds the result as xarray reads it.  Its subgroup ``sweep`` has the rest: ``inputs``, the
shape of chunks, versions, ``done``, one flag a chunk, and ``manifest``, the checksum and origin of
each file.
"""

import contextlib
import warnings
from typing import Any

import xarray

from ..errors import RateStateError, StoreError
from . import sentence
from .chunks import chunks_of
from .inputs import checksum, input_differences, inputs_of
from .legacy import DAMAGE, SWEEP_GROUP
from .manifest import Checked, as_lines, damage_message
from .record import Record
from .writing import FILL_VALUES

# Up to so many cases all messages are read at once.
MOST_MESSAGES = 10**7


@contextlib.contextmanager
def as_store_error(path):
    """Context manager: an error from reading a damaged store, or no store, becomes a StoreError.

    Other errors go on as they are: those of this package, and those of stores whose files are all
    as they were written.
    """
    try:
        yield
    except RateStateError:
        raise
    except PermissionError as error:
        raise StoreError(sentence("store.unreadable", path=path, error=error.strerror)) from error
    except DAMAGE as error:
        if message := _damage(path, error):
            raise StoreError(message) from error
        raise


def _damage(path, error):
    """The message about an error from reading a store; "" if no file of it is to blame."""
    if not path.exists():
        return sentence("store.nothing", path=path)
    if not (path / SWEEP_GROUP).is_dir():
        return sentence("store.none", path=path, error=error)
    try:
        flaws = Record(path).flaws
    except DAMAGE:
        return sentence("damage.inputs", path=path, why=f"{SWEEP_GROUP}: {error}")
    inputs = f"{SWEEP_GROUP}/inputs/"
    if lost := [file for file in flaws if file.key.startswith(inputs)]:
        return sentence("damage.inputs", path=path, why=lost[0])
    if flaws:
        return damage_message(path, flaws)
    of_system = isinstance(error, OSError)
    return sentence("store.unreadable", path=path, error=error) if of_system else ""


def read_record(path):
    """The `Record` of a store, and the inputs of its sweep (Dataset).

    StoreError if there is no store, or one of them is damaged; other files are not checked.
    """
    with as_store_error(path):
        record = Record(path)
        how: dict[str, Any] = {"consolidated": False, "decode_cf": False, "zarr_format": 3}
        group = f"{SWEEP_GROUP}/inputs"
        with xarray.open_zarr(path, group=group, chunks=None, **how) as data:
            inputs = data.load()
    needed = {"verb", "sizes", "chunk", "device", "checksum", "versions"}
    if not needed <= {*record.attrs} or checksum(inputs) != record.attrs["checksum"]:
        raise StoreError(sentence("damage.inputs", path=path, why="its checksum is another"))
    return record, inputs


def matching_record(path, request):
    """The `Record` of a store; StoreError, with the differences, if it is of another sweep."""
    record, inputs = read_record(path)
    lines = input_differences(inputs, inputs_of(request.name, request.call))
    chunks, device, chunk = record.chunks, record.attrs["device"], request.chunk
    if request.device != device:
        lines.append(f"device: {device} in the store, {request.device} now")
    if chunk is not None and chunks_of(chunks.sizes, chunk).shape != chunks.shape:
        lines.append(f"chunk: blocks of {chunks.shape} cases in the store, chunk={chunk} now")
    if lines:
        raise StoreError(sentence("store.other_sweep", path=path, lines=as_lines(lines)))
    return record


def device_attrs(device):
    """Attributes of a result that name its device, {} for a CPU: a GPU differs in last digits."""
    return {} if device == "cpu" else {"device": device}


def open_result(path):
    """The result in a store, a Dataset, read and checked when it is used.

    Of cases not done integers are -1, the status too, and all else NaN, False or "".  StoreError if
    it cannot be opened, and on use if a file is damaged or missing.
    """
    with as_store_error(path):
        record = Record(path)
        checked = Checked(path, files=record.files)
        data = xarray.open_zarr(checked, chunks=None, decode_cf=False, zarr_format=3)
        if not record.done.all():
            for variable in data.data_vars.values():
                if variable.dtype.kind in "fc":
                    variable.attrs["_FillValue"] = FILL_VALUES[variable.dtype.kind]
        data = xarray.decode_cf(data)
        if data["message"].size > MOST_MESSAGES:
            return data
        return data.assign(message=data["message"].astype(object))  # see `python_text`


def load_result(path):
    """The result in a store, a Dataset in memory; StoreError if a file is damaged or missing."""
    with as_store_error(path):
        return open_result(path).load()


def python_text(data):
    """The same with text as Python has it: Zarr 3 specifies no other, and xarray masks no other."""
    texts = {k: v.astype(object) for k, v in data.variables.items() if v.dtype.kind in "UT"}
    return data.assign(texts)


@contextlib.contextmanager
def zarr_3_warnings_ignored():
    """Context manager without UserWarnings: zarr's are of text and consolidated metadata.

    All readers of Zarr 3 know these.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        yield
