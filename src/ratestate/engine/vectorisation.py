"""Whether the loops over lanes are SIMD code, as the compiled code itself tells.

LLVM leaves a loop that it cannot vectorise as it is, without a word, and it runs at a sixth of the
speed.  The loops go over whole vectors, so that a vectorised one holds no products of single
numbers.
"""

import re

from numba.core.registry import cpu_target

#: the loops over lanes, of the modules of that name and of `waveform`, in LLVM's own text
NAMES = r"(?:lanes|waveform)\d+(?:advance|find|commit|add)"
LOOPS = re.compile(rf"^define [^@\n]*@[^(\n]*{NAMES}.*?^}}", re.M | re.S)
ALONE = re.compile(r"= fmul (?:contract )?double")
VECTORS = re.compile(r"= fmul (?:contract )?<\d+ x double>")
# A few products of single numbers may be left.
FEW = 0.05


def doubles_of_vector():
    """How many doubles the vectors have to which LLVM compiles for this processor."""
    _, processor, features = cpu_target.target_context.codegen().magic_tuple()
    if "+avx512f" in features and processor.startswith(("znver", "knl", "knm")):
        return 8  # (for others LLVM takes half of their widest)
    return 4 if "+avx" in features else 2


def products(library):
    """Products of single numbers, and of vectors, in a kernel's loops over lanes.

    (0, 0) where it has none.

    library : numba's, just compiled; of one that was loaded the text is not known
    """
    loops = LOOPS.findall(library.get_llvm_str())
    return tuple(sum(len(kind.findall(loop)) for loop in loops) for kind in (ALONE, VECTORS))


def is_vectorised(counted):
    """Whether all but a small part of what `products` counted is vectorised."""
    alone, vectors = counted
    return alone <= FEW * (alone + vectors)
