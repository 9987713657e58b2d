"""Resuming a store: checks what began it, and finds and restores damaged files."""

import json
import warnings
from typing import Any

import zarr

from ..dynamics.recipe import versions
from ..errors import StoreError
from . import sentence
from .create import add_record, make, temporary_sibling
from .legacy import METADATA, SWEEP_GROUP
from .manifest import MANIFEST, RECORDS, as_lines, content_of
from .origin import origin_differences
from .record import Record
from .store import as_store_error, matching_record, zarr_3_warnings_ignored
from .writing import Store, to_disk


def resume_store(path, request):
    """Restore damaged files of the store at a path, and open it as a `Store`.

    The process must hold its lock.  Its `done` lacks chunks that have damaged files.  StoreError:
    the store of another sweep or origin, or damage that cannot be mended; RuntimeWarnings name what
    was mended, and in a mixed sweep how the origins differ.
    """
    matching_record(path, request)
    # outside of `as_store_error`, since errors in these are not of the store's making
    now, (computed, coordinates) = request.origin, _layouts(request)
    record, flaws = _mended(path, request)
    with as_store_error(path):
        names = _variables(record, computed, coordinates, request.mixed)
        done = record.intact(flaws)
        _check_origins(record, done, now, request.mixed)
        if "manifest" not in record.group:  # an older version's
            with zarr_3_warnings_ignored():
                sweep_group = zarr.open_group(path / SWEEP_GROUP, mode="r+", zarr_format=3)
                add_record(sweep_group, "manifest", str, len(done) + 1)
            to_disk([path / MANIFEST / METADATA], path)
        for partial in path.rglob("*.partial"):  # of writers that were killed
            partial.unlink(missing_ok=True)
    if flaws:
        _warn("damage.mended", path, [*flaws])
    return Store(path, record.chunks, done, record.attrs["checksum"], names)


def _mended(path, request):
    """The `Record` of a store with all files that were made with it, and the flaws that it had."""
    flaws: dict = {}
    while True:
        with as_store_error(path):
            record = Record(path)
            flaws |= dict.fromkeys(record.flaws)
        lost = [file for file in record.flaws if file.chunk is None]
        if not lost:
            return record, flaws
        try:
            _restore(record, lost, request)
        except OSError as error:
            lines = as_lines(lost)
            message = sentence("damage.not_mended", path=path, error=error, lines=lines)
            raise StoreError(message) from error


def _restore(record, flaws, request):
    """Replace the flawed files, of those that were made with the store."""
    path = record.path
    if RECORDS not in record.attrs or record.attrs["versions"] != json.loads(versions()):
        raise StoreError(sentence("damage.other_version", path=path, lines=as_lines(flaws)))
    with temporary_sibling(path) as temporary:
        make(temporary, request, record.chunks)
        if other := [
            file for file in flaws if file.checked_against(content_of(temporary / file.key)).flaw
        ]:
            raise StoreError(sentence("damage.hopeless", path=path, lines=as_lines(other)))
        for key in (file.key for file in flaws):
            for folder in reversed((path / key).parents):
                if path in folder.parents:  # not the store's own
                    folder.mkdir(exist_ok=True)
            (temporary / key).replace(path / key)
            to_disk([path / key], path)


def _check_origins(record, done, now, mixed):
    """Refuse, in a sweep that is not mixed, to resume what another origin has begun."""
    made = [record.entries.get(i, record.attrs) for i in done.nonzero()[0].tolist()]
    lines = dict.fromkeys(
        line for one in [record.attrs, *made] for line in origin_differences(one, now)
    )
    if lines and not mixed:
        text = as_lines([*lines])
        raise StoreError(sentence("origin.refused", path=record.path, lines=text))
    if lines:
        _warn("origin.mixed", record.path, [*lines])
    elif any("processor" not in one for one in made):
        _warn("origin.not_recorded", record.path)


def _layouts(request):
    """Return the layouts of the variables that are computed, by name, and the names of others."""
    form = request.form
    others = request.call.dataset(form.static).variables.keys() - form.specs.keys()
    layouts = {name: _layout(spec.dims, spec.dtype) for name, spec in form.specs.items()}
    return layouts, others


def _variables(record, computed, coordinates, mixed):
    """Names of the variables that the store has and this version computes.

    They must be the same; in a mixed sweep, this version may compute more.
    """
    path = record.path
    group: Any = zarr.open_group(path, mode="r", zarr_format=3, use_consolidated=False)
    stored = {
        name: _layout(array.metadata.dimension_names or (), array.dtype)
        for name, array in group.arrays()
        if name not in coordinates
    }
    if stored == computed:
        return frozenset(computed)
    pairs = {name: (stored.get(name), computed.get(name)) for name in sorted({*stored, *computed})}
    lines = [
        f"variable {name}: {old or 'none'} in the store, {new or 'none'} now"
        for name, (old, new) in pairs.items()
        if old != new
    ]
    if not mixed or not stored.items() <= computed.items():
        remedy = "" if mixed else ", or mixed=True (--mixed), if all that it has are here"
        text = as_lines(lines)
        raise StoreError(sentence("origin.variables", path=path, remedy=remedy, lines=text))
    _warn("origin.fewer_variables", path, lines)
    return frozenset(stored)


def _layout(dims, dtype):
    """Dimensions and type of a variable, as text."""
    return f"{'text' if dtype.kind in 'OTU' else dtype} over ({', '.join(dims)})"


def _warn(name, path, lines=()):
    message = sentence(name, path=path, lines=as_lines(lines))
    warnings.warn(message, RuntimeWarning, stacklevel=5)
