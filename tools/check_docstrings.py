"""Ends with an error where the docstring of a public name is not complete numpydoc.

Public is what docs/reference/api.md names: a summary, every parameter and what is returned.
"""

import functools
import importlib
import inspect
import re
import sys
import types
from pathlib import Path

from numpydoc.docscrape import get_doc_object
from numpydoc.validate import validate

REFERENCE = Path(__file__).resolve().parents[1] / "docs/reference/api.md"
#: checks of numpydoc that are not made: sections that not every function needs, and style that
#: symbols and names of the paper do not follow
NOT_CHECKED = {"ES01", "EX01", "SA01", "SS05", "PR08", "RT04"}


METHODS = types.FunctionType, classmethod, staticmethod, property, functools.cached_property


def public_objects():
    """(name, object) of all that the reference documents, public methods of its classes too."""
    directive = re.compile(r"^\.\. auto(\w+):: ratestate\.(\S+)(\n   :members:)?", re.MULTILINE)
    for _, name, members in directive.findall(REFERENCE.read_text("utf-8")):
        value = find(name)
        yield name, value
        if members:
            for member, function in inspect.getmembers_static(value):
                if not member.startswith("_") and isinstance(function, METHODS):
                    yield f"{name}.{member}", getattr(value, member)


def find(name):
    """Return the object of a documented name."""
    module, _, member = f"ratestate.{name}".rpartition(".")
    return getattr(importlib.import_module(module), member)


def problems(value):
    """What numpydoc finds wrong with the docstring of an object."""
    documented = get_doc_object(value)
    # a class that lists its attributes is made by functions, not by its users
    not_checked = NOT_CHECKED | ({"PR01"} if "Attributes\n" in (value.__doc__ or "") else set())
    return [text for code, text in validate(documented)["errors"] if code not in not_checked]


def main():
    lines = [f"{name}: {text}" for name, value in public_objects() for text in problems(value)]
    if lines:
        sys.exit("\n".join([*lines, f"error: {len(lines)} faults in docstrings"]))


if __name__ == "__main__":
    main()
