"""The problems of a scenario file in its error."""

import re


def problem_lines(error):
    """The lines below the title of an error, without the numbers of the file's lines."""
    return [re.sub(r"^line \d+, ", "", line) for line in str(error).splitlines()[1:]]
