"""A law that a user brings: read from a file or a class, and named with a hash of its content.

The content is the source and everything outside the class that its methods refer to: constants,
helper functions, base classes and closures (`law_content.py`).  An edited law therefore has another
name and kernels of its own, and each result names the law that made it.  A law file is Python code
that runs when it is read: only its user's own action reads it.
"""

import hashlib
import re
import sys
import traceback
import types
from pathlib import Path

from ..errors import ParameterError
from .law import FrictionLaw
from .law_content import LAW_FILE, content_of

#: between a law's own name and the hash of its content
MARK = "@"
#: what a user's code may raise, but for an interrupt
RAISED = (Exception, SystemExit)
NAME = re.compile(r"[a-z][a-z0-9-]*")


def law_of_file(path):
    """The class of laws in a Python file, which is run; ParameterError unless there is just one."""
    try:
        if Path(path).exists() and not Path(path).is_file():  # a folder, or a device without end
            raise OSError(0, "it is not a file")
        text = Path(path).read_text("utf-8")
    except (OSError, ValueError) as error:  # (another encoding, or a null character in the path)
        reason = getattr(error, "strerror", None) or error
        raise ParameterError(f"law file {path} cannot be read: {reason}") from None
    kind = law_of_text(text, path)
    kind.file = Path(path).resolve()
    return kind


def law_of_text(text, path):
    """`law_of_file` of a file with this text, which was at this path."""
    module = types.ModuleType(f"{LAW_FILE}{_hash(text)}")
    module.__file__ = str(path)
    sys.modules[module.__name__] = module  # where pickle looks for its class
    try:
        exec(compile(text, str(path), "exec"), module.__dict__)
        found = [x for x in vars(module).values() if _is_law(x) and x.__module__ == module.__name__]
        names = ", ".join(kind.__name__ for kind in found) or "none"
    except RAISED as error:
        del sys.modules[module.__name__]
        frames = traceback.extract_tb(error.__traceback__)
        lines = [frame.lineno for frame in frames if frame.filename == str(path)]
        line = getattr(error, "lineno", None) or (lines[-1] if lines else 1)
        reason = reason_of(error)
        raise ParameterError(f"law file {path} cannot be loaded, line {line}: {reason}") from None
    if len(found) != 1:
        raise ParameterError(
            f"law file {path} must hold one class that derives from ratestate.FrictionLaw; it "
            f"holds {names}"
        )
    found[0].source = text
    return found[0]


def reason_of(error):
    """Return the kind of an error and the first line of its text, if that can be had."""
    kind = type(error).__name__
    try:
        return f"{kind}: {error}".splitlines()[0]
    except RAISED:
        return kind


def named_law(kind):
    """An instance of a class of laws, under its name with the hash of its content.

    ParameterError if it is not such a class, or its name is not a valid one.
    """
    if not _is_law(kind):
        raise ParameterError(f"{kind!r} must be a class that derives from ratestate.FrictionLaw")
    name = getattr(kind, "name", None)
    if not (isinstance(name, str) and NAME.fullmatch(name)):
        raise ParameterError(
            f"{kind.__name__}.name = {name!r} must be a name in small letters, digits and -, such "
            f"as name = 'mine'"
        )
    law = kind()
    law.name = _full_name(kind)
    if not isinstance(getattr(kind, "label", None), str):
        law.label = f"{name} law"
    return law


def is_unchanged(law):
    """Whether all that a law refers to is as it was when the law was registered."""
    while hasattr(law, "inner"):  # it is composed of another law and damping, say
        law = law.inner
    try:
        return MARK not in law.name or law.name == _full_name(type(law))
    except ParameterError:  # of what cannot be recorded
        return False


def _full_name(kind):
    return f"{kind.name}{MARK}{_hash(content_of(kind))}"


def _is_law(value):
    return isinstance(value, type) and issubclass(value, FrictionLaw) and value is not FrictionLaw


def _hash(text):
    return hashlib.sha256(text.encode()).hexdigest()[:8]
