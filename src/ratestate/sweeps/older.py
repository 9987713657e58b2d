"""Stores of older versions, which have no manifest: what they hold, and how far that is known.

Files of chunks are known by the flags; those of coordinates as far as they are there.  All have
the checksum of their codec.  Metadata are there twice: by themselves, and joined at the top.
"""

import json
import re
from types import SimpleNamespace

import zarr

INSIDE = "sweep"
METADATA = "zarr.json"
#: what damaged files may raise, in zarr and its codecs
DAMAGE = (OSError, KeyError, TypeError, ValueError, RuntimeError)


def files(path, chunks, done):
    """(key, chunk or None) of the files that a store must have.

    done : numbers of the chunks that are done, but in no manifest
    """
    nodes, attributes = _nodes(path)
    # (the time of a run is a coordinate, and yet a result)
    coordinates = {*chunks.sizes, *attributes["coordinates"].split()} - {"t"}
    arrays = {
        name: SimpleNamespace(dims=tuple(node.get("dimension_names") or ()))
        for name, node in nodes.items()
        if node["node_type"] == "array" and "/" not in name
    }
    swept = {
        name: array
        for name, array in arrays.items()
        if name not in coordinates and chunks.sizes.keys() & array.dims
    }
    found = [(f"{name}/{METADATA}", None) for name in nodes]
    for name in arrays.keys() - swept.keys():
        blocks = (path / name).rglob("*")
        keys = [one.relative_to(path).as_posix() for one in blocks if one.is_file()]
        found += [(key, None) for key in keys if not key.endswith(METADATA)]
    return found + [(key, i) for i in done for key in chunks.keys(i, swept).values()]


def array_and_block(key):
    """Array, and indices of the block, that a file of a store has; ("", None): it has metadata."""
    match = re.fullmatch(r"(.+)/c((?:/\d+)*)", key)
    return (match[1], tuple(map(int, match[2].split("/")[1:]))) if match else ("", None)


def is_whole(path, key):
    """Whether a file of a store is as it was written, as far as that can be told."""
    name, block = array_and_block(key)
    try:
        if block is None:
            name = key.removesuffix(f"/{METADATA}")
            return _plain(json.loads((path / key).read_text())) == _plain(_nodes(path)[0][name])
        zarr.open_array(path / name, mode="r").blocks[block]
    except DAMAGE:
        return False
    return True


def _nodes(path):
    """Path -> metadata of each group and array in a store, as joined at its top; its attributes."""
    top = json.loads((path / METADATA).read_text())
    return top["consolidated_metadata"]["metadata"], top["attributes"]


def _plain(metadata):
    """Metadata of a group or array alone."""
    return {key: value for key, value in metadata.items() if key != "consolidated_metadata"}
