"""Resuming a store: checks what began it, and finds and restores damaged files."""

import json
import warnings
from typing import Any

import zarr

from ..dynamics.results import versions
from ..errors import StoreError
from .create import add_record, make, temporary_sibling
from .legacy import METADATA, SWEEP_GROUP
from .manifest import MANIFEST, RECORDS, Record, as_lines
from .origin import origin_differences
from .store import Store, as_store_error, matching_record, to_disk, zarr_3_warnings_ignored


def resume_store(path, request, origin):
    """Restore damaged files of the store at a path, and open it; the process must hold its lock.

    origin : of what is to compute the rest
    """
    record = matching_record(path, request)
    with as_store_error(path):
        flaws = dict.fromkeys(record.flaws)
        while lost := [flaw for flaw in record.flaws if flaw.file.chunk is None]:
            _restore(record, lost, request)
            record = Record(path)
            flaws |= dict.fromkeys(record.flaws)
        names = _variables(record, request)
        done = record.intact(flaws)
        _check_origins(record, done, origin, request.mixed)
        if "manifest" not in record.group:  # an older version's
            with zarr_3_warnings_ignored():
                sweep_group = zarr.open_group(path / SWEEP_GROUP, mode="r+")
                add_record(sweep_group, "manifest", str, len(done) + 1)
            to_disk([path / MANIFEST / METADATA], path)
        for partial in path.rglob("*.partial"):  # of writers that were killed
            partial.unlink(missing_ok=True)
    if flaws:
        _warn(
            f"{path} was damaged; these are made again, and the rest is whole:{as_lines([*flaws])}"
        )
    return Store(path, record.chunks, done, record.attrs["checksum"], names)


def _restore(record, flaws, request):
    """Replace the flawed files, of those that were made with the store."""
    path = record.path
    if RECORDS not in record.attrs or record.attrs["versions"] != json.loads(versions()):
        raise StoreError(
            f"{path} is damaged, and the version that made it is not here to mend it; put back "
            f"from a copy:{as_lines(flaws)}"
        )
    with temporary_sibling(path) as temporary:
        make(temporary, request, record.chunks)
        files = [flaw.file for flaw in flaws]
        same = [
            (temporary / file.key).exists() and not file.flaw((temporary / file.key).read_bytes())
            for file in files
        ]
        if other := [flaw for flaw, whole in zip(flaws, same, strict=True) if not whole]:
            raise StoreError(
                f"{path} is damaged, and cannot be mended; put back from a copy:{as_lines(other)}"
            )
        for key in (file.key for file in files):
            (path / key).parent.mkdir(parents=True, exist_ok=True)
            (temporary / key).replace(path / key)
            to_disk([path / key], path)


def _check_origins(record, done, origin, mixed):
    """Refuse, unless `mixed`, to resume what another origin has begun."""
    made = [record.entries.get(i, record.attrs) for i in done.nonzero()[0].tolist()]
    lines = dict.fromkeys(
        line for one in [record.attrs, *made] for line in origin_differences(one, origin)
    )
    what = f"{record.path} was begun by other programs, or on another kind of processor"
    if lines and not mixed:
        raise StoreError(
            f"{what}: the last digits of its cases would be of two kinds.  Nothing of it is lost: "
            f"go on where it was begun, give this sweep a store of its own, or go on all the same "
            f"with mixed=True (--mixed); the store says what made which chunk:{as_lines([*lines])}"
        )
    if lines:
        _warn(f"{what}; the store says what made which chunk:{as_lines([*lines])}")
    elif any("processor" not in one for one in made):
        _warn(
            f"{record.path} does not say on what kind of processor it was begun; if on another one "
            f"than this, the last digits of its cases are of two kinds"
        )


def _variables(record, request):
    """Names of the variables that the store has and this version computes.

    They must be the same; in a mixed sweep, this version may compute more.
    """
    path, form = record.path, request.form
    group: Any = zarr.open_group(path, mode="r", use_consolidated=False)
    coordinates = request.call.dataset(form.static).coords.keys() - form.specs.keys()
    stored = {
        name: _layout(array.metadata.dimension_names or (), array.dtype)
        for name, array in group.arrays()
        if name not in coordinates
    }
    computed = {name: _layout(spec.dims, spec.dtype) for name, spec in form.specs.items()}
    if stored == computed:
        return frozenset(computed)
    pairs = {name: (stored.get(name), computed.get(name)) for name in sorted({*stored, *computed})}
    lines = [
        f"variable {name}: {old or 'none'} in the store, {new or 'none'} now"
        for name, (old, new) in pairs.items()
        if old != new
    ]
    if not request.mixed or not stored.items() <= computed.items():
        raise StoreError(
            f"{path} was begun by another version, with other variables; nothing of it is lost: go "
            f"on with that version, or give this sweep a store of its own"
            + ("" if request.mixed else ", or mixed=True (--mixed), if all that it has are here")
            + f":{as_lines(lines)}"
        )
    _warn(
        f"{path} was begun by another version, and has no room for all variables:{as_lines(lines)}"
    )
    return frozenset(stored)


def _layout(dims, dtype):
    """Dimensions and type of a variable, as text."""
    return f"{'text' if dtype.kind in 'OTU' else dtype} over ({', '.join(dims)})"


def _warn(message):
    warnings.warn(message, RuntimeWarning, stacklevel=5)
