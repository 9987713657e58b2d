"""A law that a user brings: read from a file or a class, and named with a hash of its source.

So a law that is edited is another one, with kernels of its own, and results say by which they are.
A law file is code, which runs when it is read: nothing but its user does that.
"""

import hashlib
import inspect
import re
import sys
import traceback
import types
from pathlib import Path

from ..errors import ParameterError
from .law import FrictionLaw

#: between a law's own name and the hash of its source
MARK = "@"
NAME = re.compile(r"[a-z][a-z0-9-]*")


def law_of_file(path):
    """The class of laws in a Python file, which is run; ParameterError unless there is just one."""
    try:
        if Path(path).exists() and not Path(path).is_file():  # a folder, or a device without end
            raise OSError(0, "it is no file")
        text = Path(path).read_text("utf-8")
    except (OSError, ValueError) as error:  # (another encoding, or a null character in the path)
        reason = getattr(error, "strerror", None) or error
        raise ParameterError(f"law file {path} cannot be read: {reason}") from None
    kind = law_of_text(text, path)
    kind.file = Path(path).resolve()
    return kind


def law_of_text(text, path):
    """`law_of_file` of a file with this text, which was at this path."""
    module = types.ModuleType(f"ratestate_law_{_hash(text)}")
    module.__file__ = str(path)
    sys.modules[module.__name__] = module  # where pickle looks for its class
    try:
        exec(compile(text, str(path), "exec"), module.__dict__)
    except (Exception, SystemExit) as error:
        del sys.modules[module.__name__]
        frames = traceback.extract_tb(error.__traceback__)
        lines = [frame.lineno for frame in frames if frame.filename == str(path)]
        line = getattr(error, "lineno", None) or (lines[-1] if lines else 1)
        reason = f"{type(error).__name__}: {error}".splitlines()[0]
        raise ParameterError(f"law file {path} cannot be loaded, line {line}: {reason}") from None
    found = [x for x in vars(module).values() if _is_law(x) and x.__module__ == module.__name__]
    if len(found) != 1:
        names = ", ".join(kind.__name__ for kind in found) or "none"
        raise ParameterError(
            f"law file {path} must hold one class that derives from ratestate.FrictionLaw; it "
            f"holds {names}"
        )
    found[0].source = text
    return found[0]


def named_law(kind):
    """An instance of a class of laws, under its name with the hash of its source.

    ParameterError where it is no such class, or its name is none.
    """
    if not _is_law(kind):
        raise ParameterError(f"{kind!r} is no class that derives from ratestate.FrictionLaw")
    name = getattr(kind, "name", None)
    if not (isinstance(name, str) and NAME.fullmatch(name)):
        raise ParameterError(
            f"{kind.__name__}.name = {name!r} must be a name in small letters, digits and -, such "
            f"as name = 'mine'"
        )
    law = kind()
    law.name = f"{name}{MARK}{_hash(_source(kind))}"
    if not isinstance(getattr(kind, "label", None), str):
        law.label = f"{name} law"
    return law


def _is_law(value):
    return isinstance(value, type) and issubclass(value, FrictionLaw) and value is not FrictionLaw


def _source(kind):
    """The source of a class, or its bytecode where there is no source, as in an interpreter."""
    if source := vars(kind).get("source"):
        return source
    try:
        return inspect.getsource(kind)
    except (OSError, TypeError):
        codes = [x.__code__ for x in vars(kind).values() if inspect.isfunction(x)]
        return repr([(code.co_code, code.co_consts, code.co_names) for code in codes])


def _hash(text):
    return hashlib.sha256(text.encode()).hexdigest()[:8]
