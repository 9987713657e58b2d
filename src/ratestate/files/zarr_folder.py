"""Zarr folders: a result with the checksums of its files, or the store of a finished sweep."""

from typing import Any

from ..errors import ParameterError
from .place import CHECKSUMS


def write_zarr(data, path):
    """Write a Dataset as a Zarr group, and in it a group with the SHA-256 of each file."""
    import zarr

    from ..sweeps.manifest import RECORDS, digests_of, keys_in
    from ..sweeps.store import python_text, zarr_3_warnings_ignored

    if CHECKSUMS in data.variables:
        raise ParameterError(
            f"a variable called {CHECKSUMS!r} clashes with those of the files; rename it"
        )
    with zarr_3_warnings_ignored():
        data = python_text(data).drop_encoding()
        data.to_zarr(path, mode="w-", zarr_format=3, consolidated=False)
        checksums = zarr.open_group(path, mode="r+", zarr_format=3).create_group(CHECKSUMS)
        zarr.consolidate_metadata(path)  # which names the group too: it cannot be lost unnoticed
        keys = [key for key in keys_in(path) if not key.startswith(f"{CHECKSUMS}/")]
        checksums.attrs[RECORDS] = digests_of(path, keys)


def read_zarr(path):
    """The Dataset in a Zarr folder; ParameterError, or a sweep's StoreError, if it is damaged.

    StoreError if it is in Zarr format 2.
    """
    import xarray

    from ..sweeps import sentence
    from ..sweeps.manifest import as_lines
    from ..sweeps.record import refuse_zarr_2
    from ..sweeps.store import load_result, python_text

    refuse_zarr_2(path)
    if (path / "sweep").is_dir():  # such a store knows itself what must be in it
        return python_text(load_result(path))
    if flaws := _flaws(path):
        raise ParameterError(sentence("damage.hopeless", path=path, lines=as_lines(flaws)))
    with xarray.open_zarr(path, chunks=None, zarr_format=3) as opened:
        return python_text(opened.load())


def _flaws(path):
    """The files of a result that are missing or damaged; none of an older version's, unchecked."""
    import zarr

    from ..sweeps.manifest import RECORDS, File, flaws_among

    # a damaged list of the groups may lack this one, and it may be lost itself: either is enough
    how: Any = {"mode": "r", "zarr_format": 3}
    if not (path / CHECKSUMS).exists() and CHECKSUMS not in zarr.open_group(path, **how):
        return []
    digests: Any = zarr.open_group(path / CHECKSUMS, **how).attrs[RECORDS]
    return flaws_among(path, [File(key, digest=digest) for key, digest in digests.items()])
