"""Stores of older versions, which have no manifest: the files they must have, and checks of these.

The flags tell which files of chunks must exist; of coordinates only existing files are known.  All
of these carry the checksum of their codec.  Metadata are stored twice: for each array and group,
and consolidated at the top.
"""

import json
import re

import zarr

SWEEP_GROUP = "sweep"
METADATA = "zarr.json"
#: errors that damaged files may raise in zarr and its codecs
DAMAGE = (OSError, KeyError, TypeError, ValueError, RuntimeError)


def files(path, chunks, done):
    """List of (key, chunk) of each file that a store must have; chunk None: made with the store.

    done : numbers of the chunks that are done and have no entry in a manifest
    """
    nodes, attributes = _nodes(path)
    # (the time of a run is a coordinate, but also a result)
    coordinates = {*chunks.sizes, *attributes["coordinates"].split()} - {"t"}
    dims = {
        name: tuple(node.get("dimension_names") or ())
        for name, node in nodes.items()
        if node["node_type"] == "array" and "/" not in name
    }
    swept = {
        name: own
        for name, own in dims.items()
        if name not in coordinates and chunks.sizes.keys() & own
    }
    pairs = [(f"{name}/{METADATA}", None) for name in nodes]
    for name in dims.keys() - swept.keys():
        blocks = [one for one in (path / name).rglob("*") if one.is_file() and one.name != METADATA]
        pairs += [(one.relative_to(path).as_posix(), None) for one in blocks]
    return pairs + [(key, i) for i in done for key in chunks.file_keys(i, swept).values()]


def array_and_block(key):
    """Name of the array and indices (tuple) of the block in a file; ("", None) for metadata."""
    match = re.fullmatch(r"(.+)/c((?:/\d+)*)", key)
    return (match[1], tuple(map(int, match[2].split("/")[1:]))) if match else ("", None)


def is_whole(path, key):
    """Whether a file of a store is there and passes the checks that it has.

    Metadata must be as consolidated at the top; a block must decode, with its codec's checksum.
    """
    name, block = array_and_block(key)
    try:
        if block is None:
            name = key.removesuffix(f"/{METADATA}")
            return _plain(json.loads((path / key).read_text())) == _plain(_nodes(path)[0][name])
        zarr.open_array(path / name, mode="r", zarr_format=3).blocks[block]
    except DAMAGE:
        return False
    return True


def _nodes(path):
    """Consolidated metadata of a store, path -> metadata of a group or array; its attributes."""
    top = json.loads((path / METADATA).read_text())
    return top["consolidated_metadata"]["metadata"], top["attributes"]


def _plain(metadata):
    """Metadata of a group or array without those of its members."""
    return {key: value for key, value in metadata.items() if key != "consolidated_metadata"}
