"""Chunks of a sweep: blocks of cases, each solved by one task and stored in one file a variable."""

import dataclasses
import math

import numpy as np


@dataclasses.dataclass(frozen=True)
class Chunks:
    """Blocks that make up a sweep, of equal shape except for the last along each dimension.

    Iterating gives the slices of each chunk: dimension -> slice.
    """

    sizes: dict  # dimension -> number of values
    shape: tuple  # those in a chunk

    @property
    def counts(self):
        """Number of chunks along each dimension, a tuple."""
        return tuple(-(-n // k) for n, k in zip(self.sizes.values(), self.shape, strict=True))

    @property
    def number(self):
        """Number of chunks."""
        return math.prod(self.counts)

    def index(self, i):
        """Index of chunk i along each dimension, a tuple; ValueError unless 0 <= i < number."""
        return tuple(map(int, np.unravel_index(i, self.counts)))

    def slices(self, i):
        """Dimension -> slice of the cases of chunk i."""
        parts = zip(self.sizes.items(), self.shape, self.index(i), strict=True)
        return {dim: slice(k * m, min((k + 1) * m, n)) for (dim, n), m, k in parts}

    def cases(self, i):
        """Number of cases in chunk i."""
        return math.prod(part.stop - part.start for part in self.slices(i).values())

    def file_keys(self, i, dims):
        """Variable -> path within a store of its file for chunk i, if this chunk writes one.

        dims : variable -> its dimensions.  If it lacks some of the sweep's, the first chunk along
        these writes it; if it lacks all, none does.
        """
        index = dict(zip(self.sizes, self.index(i), strict=True))
        paths = {}
        for name, own in dims.items():
            shared = index.keys() & {*own}
            if shared and not any(index[dim] for dim in index.keys() - shared):
                paths[name] = "/".join([name, "c", *(str(index.get(dim, 0)) for dim in own)])
        return paths

    def __iter__(self):
        return (self.slices(i) for i in range(self.number))


def chunks_of(sizes, most):
    """`Chunks` of at most `most` cases, contiguous in memory; most and sizes >= 1, not checked.

    Trailing dimensions are whole, one is divided into about equal parts, and along leading ones a
    chunk has a single value.
    """
    shape: list = []
    for n in reversed(sizes.values()):
        fits = max(1, min(n, most // math.prod(shape)))
        shape.insert(0, -(-n // -(-n // fits)))
    return Chunks(dict(sizes), tuple(shape))


def halves(sizes):
    """The longest dimension of a block, and its two halves: a list of {dimension: slice}.

    The first half is empty in a block of one case; not checked.
    """
    dim = max(sizes, key=sizes.__getitem__)
    middle = sizes[dim] // 2
    return dim, [{dim: slice(0, middle)}, {dim: slice(middle, sizes[dim])}]
