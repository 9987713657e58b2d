"""A typed text as a value in SI."""

import re

import numpy as np

from ....errors import ParameterError
from ....model.quantities import QUANTITIES, remedy
from ....model.units import to_si

LONGEST = 64  # characters of a value
# Magnitudes [SI] beyond which nothing exists, and numbers overflow.
SMALLEST, LARGEST = 1e-20, 1e20
_DIGIT = re.compile(r"^[-+]?[0.]*[1-9]")  # of a number that is not 0, at its beginning
_BARE = re.compile(r"[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|inf)")


def value(symbol, text, label, bound=None):
    """The value [SI] of a quantity in a text; a number without a unit is in SI.

    ParameterError, which names the `label`, for any other text, and beyond the `bound` (`to_si`).
    """
    if not isinstance(text, str):
        problem = "has no text"
    elif len(text) > LONGEST:
        problem = f"is longer than {LONGEST} characters"
    elif not (text := text.strip()):
        problem = "is empty"
    else:
        unit = QUANTITIES[symbol].unit
        bare = unit != "1" and _BARE.fullmatch(text)
        found = to_si(symbol, f"{text} {unit}" if bare else text, label=label, bound=bound)
        exact = (found == 0.0 and not _DIGIT.search(text)) or (np.isinf(found) and "inf" in text)
        if exact or SMALLEST <= abs(found) <= LARGEST:
            return found
        problem = f"= {text!r} is beyond any size"
    raise ParameterError(f"{label} {problem}", remedy(symbol))


def factor(text, label):
    """The factor in a text, a number > 0 that is not 1; ParameterError for any other text."""
    wanted = "expected a number > 0 that is not 1, such as 10"
    if not isinstance(text, str) or len(text) > LONGEST:
        raise ParameterError(f"{label} has no text of {LONGEST} characters at most; {wanted}")
    number = float(text) if _BARE.fullmatch(text.strip()) else np.nan
    if number == 1.0 or not SMALLEST <= number <= LARGEST:
        raise ParameterError(f"{label} = {text!r} is of no use; {wanted}")
    return number
