"""Going on with a store: only with what began it, and after what is damaged has been found."""

import json
import os
import shutil
import warnings
from typing import Any

import zarr

from ..dynamics.results import versions
from ..errors import StoreError
from .create import add_record, make, sibling
from .manifest import MANIFEST, RECORDS, contents, flawed_records, flaws, listed, sha256, whole
from .older import INSIDE, METADATA
from .origin import differences
from .store import Store, chunks_in, damage_told, examined, sweep_up, to_disk


def resumed(path, form, asked, here, mixed):
    """The `Store` at a path, ready to be gone on with by the process that holds it.

    Parameters
    ----------
    path : Path
    form : Form
        Of the result.
    asked : tuple
        Name of the verb, call, chunk and device.
    here : dict
        `ratestate.sweeps.origin.origin` of what is to do the rest.
    mixed : bool
        Whether to go on with what other programs or another kind of processor began.

    Raises
    ------
    StoreError
        It is another sweep's; others began it, and differences are listed; what is damaged cannot
        be made again.
    """
    inside = examined(path, *asked)
    with damage_told(path):
        found = flawed_records(path, inside)
        if found:
            _make_again(path, inside, found, form, asked)
        held = contents(path, inside)
        again = flaws(held)
        found += again
        done = whole(held, found)
        while own := [flaw for flaw in again if flaw.file.chunk is None]:
            _make_again(path, inside, own, form, asked)
            again = flaws(contents(path, inside))
        names = _variables(path, form, asked[1], mixed)
        _check_origins(path, inside, held, done, here, mixed)
        if "manifest" not in inside:  # an older version's
            add_record(zarr.open_group(path / INSIDE, mode="r+"), "manifest", str, len(done) + 1)
            to_disk([path / MANIFEST / METADATA], path)
        sweep_up(path)
    if found:
        _warn(f"{path} was damaged; these are made again, and the rest is whole:{listed(found)}")
    return Store(path, chunks_in(inside), done, inside.attrs["checksum"], names)


def _make_again(path, inside, found, form, asked):
    """Put in place what was made with the store, and is flawed."""
    verb, call, _, device = asked
    if RECORDS not in inside.attrs or inside.attrs["versions"] != json.loads(versions()):
        raise StoreError(
            f"{path} is damaged, and the version that made it is not here to mend it; put back "
            f"from a copy:{listed(found)}"
        )
    temporary, handle = sibling(path)
    try:
        make(temporary, verb, call, chunks_in(inside), form, device)
        other = [flaw for flaw in found if not _is_the_same(temporary, flaw.file)]
        if other:
            raise StoreError(
                f"{path} is damaged, and cannot be mended; put back from a copy:{listed(other)}"
            )
        for key in (flaw.file.key for flaw in found):
            (path / key).parent.mkdir(parents=True, exist_ok=True)
            (temporary / key).replace(path / key)
            to_disk([path / key], path)
    finally:
        os.close(handle)
        shutil.rmtree(temporary, ignore_errors=True)


def _is_the_same(folder, file):
    """Whether a `File` made again is what it was."""
    made = folder / file.key
    return made.exists() and file.digest in (None, sha256(made.read_bytes()))


def _check_origins(path, inside, held, done, here, mixed):
    """Refuse, unless `mixed`, to go on with what others have begun."""
    by = [held.entries.get(i, inside.attrs) for i in done.nonzero()[0].tolist()]
    lines = dict.fromkeys(
        line
        for one in [inside.attrs, *by]
        for line in differences(one["versions"], one.get("processor"), here)
    )
    what = f"{path} was begun by other programs, or on another kind of processor"
    if lines and not mixed:
        raise StoreError(
            f"{what}: the last digits of its cases would be of two kinds.  Nothing of it is lost: "
            f"go on where it was begun, give this sweep a store of its own, or go on all the same "
            f"with mixed=True (--mixed); the store says what made which chunk:{listed([*lines])}"
        )
    if lines:
        _warn(f"{what}; the store says what made which chunk:{listed([*lines])}")
    elif any("processor" not in one for one in by):
        _warn(
            f"{path} does not say on what kind of processor it was begun; if on another one than "
            f"this, the last digits of its cases are of two kinds"
        )


def _variables(path, form, call, mixed):
    """Names of the variables that the store has, and this version finds.

    Those of another version are to be the same; `mixed`: none that the store has may be missing.
    """
    group: Any = zarr.open_group(path, mode="r", use_consolidated=False)
    beside = call.dataset(form.static).coords.keys() - form.kinds.keys()
    stored = {name: _kind(array) for name, array in group.arrays() if name not in beside}
    found = {
        name: (tuple(kind.dims), "text" if kind.dtype == object else str(kind.dtype))
        for name, kind in form.kinds.items()
    }
    if stored == found:
        return frozenset(found)
    lines = [
        f"variable {name}: {_shown(stored.get(name))} in the store, {_shown(found.get(name))} now"
        for name in sorted({*stored, *found})
        if stored.get(name) != found.get(name)
    ]
    if not mixed or not stored.items() <= found.items():
        raise StoreError(
            f"{path} was begun by another version, with other variables; nothing of it is lost: go "
            f"on with that version, or give this sweep a store of its own"
            + ("" if mixed else ", or mixed=True (--mixed), if all that it has are here")
            + f":{listed(lines)}"
        )
    _warn(f"{path} was begun by another version, and has no room for all variables:{listed(lines)}")
    return frozenset(stored)


def _kind(array):
    """Dimensions and type of numbers of an array in a store."""
    text = array.dtype.kind in "OTU"
    return tuple(array.metadata.dimension_names or ()), "text" if text else str(array.dtype)


def _shown(kind):
    return f"{kind[1]} over ({', '.join(kind[0])})" if kind else "none"


def _warn(message):
    warnings.warn(message, RuntimeWarning, stacklevel=5)
