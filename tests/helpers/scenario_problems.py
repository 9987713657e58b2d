"""The problems of a scenario file in its error."""

import re

import pytest

from ratestate import ParameterError


def problem_lines(error):
    """The lines below the title of an error, without the numbers of the file's lines."""
    return [re.sub(r"^line \d+, ", "", line) for line in str(error).splitlines()[1:]]


def problems_of(load, *arguments, **how):
    """The problems of a scenario that `load` refuses, a line each."""
    with pytest.raises(ParameterError) as caught:
        load(*arguments, **how)
    return problem_lines(caught.value)
