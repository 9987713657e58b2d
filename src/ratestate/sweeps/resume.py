"""Resuming a store: checks what began it, and finds and restores damaged files."""

import json
import os
import shutil
import warnings
from typing import Any

import zarr

from ..dynamics.results import versions
from ..errors import StoreError
from .create import add_record, make, temporary_sibling
from .legacy import METADATA, SWEEP_GROUP
from .manifest import (
    MANIFEST,
    RECORDS,
    as_lines,
    find_flaws,
    flawed_metadata,
    intact_chunks,
    read_contents,
    sha256,
)
from .origin import origin_differences
from .store import Store, as_store_error, matching_group, remove_partials, stored_chunks, to_disk


def resume_store(path, form, request, origin, mixed):
    """Restore damaged files of the store at a path, and open it; the process must hold its lock.

    Parameters
    ----------
    path : Path
    form : Form
        Of the result.
    request : SweepRequest
    origin : dict
        `ratestate.sweeps.origin.origin` of what is to compute the rest.
    mixed : bool
        Whether to resume what other programs or another kind of processor began.

    Returns
    -------
    Store

    Raises
    ------
    StoreError
        It belongs to another sweep; it has another origin, and differences are listed; a damaged
        file cannot be restored.
    """
    sweep_group = matching_group(path, request)
    with as_store_error(path):
        flaws = flawed_metadata(path, sweep_group)
        if flaws:
            _restore(path, sweep_group, flaws, form, request)
        contents = read_contents(path, sweep_group)
        more = find_flaws(contents)
        flaws += more
        done = intact_chunks(contents, flaws)
        while of_no_chunk := [flaw for flaw in more if flaw.file.chunk is None]:
            _restore(path, sweep_group, of_no_chunk, form, request)
            more = find_flaws(read_contents(path, sweep_group))
        names = _variables(path, form, request.call, mixed)
        _check_origins(path, sweep_group, contents, done, origin, mixed)
        if "manifest" not in sweep_group:  # an older version's
            add_record(
                zarr.open_group(path / SWEEP_GROUP, mode="r+"), "manifest", str, len(done) + 1
            )
            to_disk([path / MANIFEST / METADATA], path)
        remove_partials(path)
    if flaws:
        _warn(f"{path} was damaged; these are made again, and the rest is whole:{as_lines(flaws)}")
    return Store(path, stored_chunks(sweep_group), done, sweep_group.attrs["checksum"], names)


def _restore(path, sweep_group, flaws, form, request):
    """Replace the flawed files among those that were made with the store."""
    if RECORDS not in sweep_group.attrs or sweep_group.attrs["versions"] != json.loads(versions()):
        raise StoreError(
            f"{path} is damaged, and the version that made it is not here to mend it; put back "
            f"from a copy:{as_lines(flaws)}"
        )
    temporary, handle = temporary_sibling(path)
    try:
        make(temporary, request, stored_chunks(sweep_group), form)
        other = [flaw for flaw in flaws if not _is_original(temporary, flaw.file)]
        if other:
            raise StoreError(
                f"{path} is damaged, and cannot be mended; put back from a copy:{as_lines(other)}"
            )
        for key in (flaw.file.key for flaw in flaws):
            (path / key).parent.mkdir(parents=True, exist_ok=True)
            (temporary / key).replace(path / key)
            to_disk([path / key], path)
    finally:
        os.close(handle)
        shutil.rmtree(temporary, ignore_errors=True)


def _is_original(folder, file):
    """Whether a `File` made again in a folder has its recorded checksum."""
    made = folder / file.key
    return made.exists() and file.digest in (None, sha256(made.read_bytes()))


def _check_origins(path, sweep_group, contents, done, origin, mixed):
    """Refuse, unless `mixed`, to resume what another origin has begun."""
    made = [contents.entries.get(i, sweep_group.attrs) for i in done.nonzero()[0].tolist()]
    lines = dict.fromkeys(
        line
        for one in [sweep_group.attrs, *made]
        for line in origin_differences(one["versions"], one.get("processor"), origin)
    )
    what = f"{path} was begun by other programs, or on another kind of processor"
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
            f"{path} does not say on what kind of processor it was begun; if on another one than "
            f"this, the last digits of its cases are of two kinds"
        )


def _variables(path, form, call, mixed):
    """Names of the variables that the store has and this version computes.

    They must be the same; if `mixed`, this version may compute more.
    """
    group: Any = zarr.open_group(path, mode="r", use_consolidated=False)
    coordinates = call.dataset(form.static).coords.keys() - form.specs.keys()
    stored = {name: _layout(array) for name, array in group.arrays() if name not in coordinates}
    computed = {
        name: (tuple(spec.dims), "text" if spec.dtype == object else str(spec.dtype))
        for name, spec in form.specs.items()
    }
    if stored == computed:
        return frozenset(computed)
    lines = [
        f"variable {name}: {_shown(old)} in the store, {_shown(new)} now"
        for name in sorted({*stored, *computed})
        if (old := stored.get(name)) != (new := computed.get(name))
    ]
    if not mixed or not stored.items() <= computed.items():
        raise StoreError(
            f"{path} was begun by another version, with other variables; nothing of it is lost: go "
            f"on with that version, or give this sweep a store of its own"
            + ("" if mixed else ", or mixed=True (--mixed), if all that it has are here")
            + f":{as_lines(lines)}"
        )
    _warn(
        f"{path} was begun by another version, and has no room for all variables:{as_lines(lines)}"
    )
    return frozenset(stored)


def _layout(array):
    """Dimensions and type of an array in a store."""
    text = array.dtype.kind in "OTU"
    return tuple(array.metadata.dimension_names or ()), "text" if text else str(array.dtype)


def _shown(layout):
    return f"{layout[1]} over ({', '.join(layout[0])})" if layout else "none"


def _warn(message):
    warnings.warn(message, RuntimeWarning, stacklevel=5)
