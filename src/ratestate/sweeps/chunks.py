"""How a sweep is cut: into blocks of cases, each of which one task solves and one file holds."""

import dataclasses
import math


@dataclasses.dataclass(frozen=True)
class Chunks:
    """Blocks of equal shape, but for the last along a dimension, that together make a sweep.

    Iterated over, it gives the places of each chunk: dimension -> slice.
    """

    sizes: dict  # dimension -> number of values
    shape: tuple  # those in a chunk

    @property
    def counts(self):
        """Number of chunks along each dimension."""
        return tuple(-(-n // k) for n, k in zip(self.sizes.values(), self.shape, strict=True))

    @property
    def number(self):
        """Number of chunks."""
        return math.prod(self.counts)

    def index(self, i):
        """Index of chunk i along each dimension."""
        found = []
        for count in reversed(self.counts):
            i, k = divmod(i, count)
            found.append(k)
        return tuple(reversed(found))

    def places(self, i):
        """Dimension -> slice of the cases of chunk i."""
        parts = zip(self.sizes.items(), self.shape, self.index(i), strict=True)
        return {dim: slice(k * m, min((k + 1) * m, n)) for (dim, n), m, k in parts}

    def cases(self, i):
        """Number of cases in chunk i."""
        return math.prod(part.stop - part.start for part in self.places(i).values())

    def keys(self, i, variables):
        """Variable -> path within a store of the file in which chunk i has it, where it has.

        What does not depend on some dimensions is written by the first chunk along them.
        """
        index = dict(zip(self.sizes, self.index(i), strict=True))
        found = {}
        for name, variable in variables.items():
            own = index.keys() & {*variable.dims}
            if own and not any(index[dim] for dim in index.keys() - own):
                found[name] = "/".join([name, "c", *(str(index.get(d, 0)) for d in variable.dims)])
        return found

    def __iter__(self):
        return (self.places(i) for i in range(self.number))


def chunks_of(sizes, most):
    """`Chunks` of at most so many cases, in the order in which arrays lie in memory.

    Trailing dimensions are whole, one is cut into about equal parts, and leading ones are taken
    value by value.
    """
    shape: list = []
    for n in reversed(sizes.values()):
        fits = max(1, min(n, most // math.prod(shape)))
        shape.insert(0, -(-n // -(-n // fits)))
    return Chunks(dict(sizes), tuple(shape))


def halves(sizes):
    """Places of the two halves of a block along its longest dimension; dimension -> slice."""
    dim = max(sizes, key=sizes.__getitem__)
    middle = sizes[dim] // 2
    return dim, [{dim: slice(0, middle)}, {dim: slice(middle, sizes[dim])}]
