"""The exceptions and warnings of the package.

::

    RateStateError
    |-- ParameterError   (also a ValueError)    a value, unit or name that cannot be used
    |   `-- MissingFileError (also a FileNotFoundError)  a file that does not exist
    |-- StoreError       (also an OSError)      a store that cannot be made, read or written
    |-- CompilationError (also a RuntimeError)  kernels that cannot be compiled on this machine
    `-- SolverError      (also a RuntimeError)  a run that ended without an answer
        |-- QuasiStaticInstability              M = 0 where no quasi-static solution exists
        `-- NotConverged                        no answer good enough; carries the best estimate

    UserWarning
    |-- FitWarning                              a fit that may be unreliable
    |-- RecordWarning                           rows of a record left out, or odd
    `-- RunWarning                              a run without visible motion
"""


class RateStateError(Exception):
    """Base of every error that ratestate raises on purpose."""


class ParameterError(RateStateError, ValueError):
    """A parameter has a value, unit, shape or name that cannot be used.

    `str` joins the attributes to "symbol = value unit problem. remedy."

    Attributes
    ----------
    problem : str
        What is wrong.  It begins with a verb if there is a symbol: "must be > 0".
    remedy : str
        What to do, one or more sentences, or "".
    symbol : str
        Name of the parameter, or "" if the problem does not concern one parameter.
    value : str
        The value, as it was given, or "".
    unit : str
        Unit of the value if its text has none, or "".
    sentence : str
        Name of the message, ``table.sentence``, if it is kept in a file; otherwise "".
    """

    def __init__(self, problem, remedy="", *, symbol="", value="", unit=""):
        super().__init__(problem, remedy)
        self.problem, self.remedy = problem, remedy
        self.symbol, self.value, self.unit = symbol, value, unit
        self.sentence = ""

    def __str__(self):
        return self.text(self.symbol)

    def text(self, symbol):
        """Return the message with another name of the parameter; with "" it has no name."""
        given = " ".join(filter(None, (self.value, self.unit)))
        name = f"{symbol} =" if symbol and given else symbol
        problem = " ".join(filter(None, (name, given, self.problem)))
        return " ".join(_ended(text) for text in (problem, self.remedy) if text)


def _ended(text):
    """Return a text with a full stop, unless it has an end or a list below it."""
    return text if text.endswith((".", "?")) or "\n" in text else f"{text}."


class MissingFileError(ParameterError, FileNotFoundError):
    """A file that is to be read does not exist.

    The attributes errno, filename and strerror of FileNotFoundError are None.

    Attributes
    ----------
    problem, remedy, symbol, value, unit, sentence : str
        As in `ParameterError`.
    """

    def __new__(cls, *_, **__):
        return FileNotFoundError.__new__(cls)  # would take the two texts for errno and strerror


class StoreError(RateStateError, OSError):
    """A store of results cannot be made, read or written; nothing that it holds is lost."""


class CompilationError(RateStateError, RuntimeError):
    """The solver cannot be compiled on this machine."""


class SolverError(RateStateError, RuntimeError):
    """A run ended without an answer; the message says where, why and what helps.

    Attributes
    ----------
    best : xarray.Dataset or None
        What was found until then, if it is of use.
    """

    def __init__(self, message, best=None):
        super().__init__(message)
        self.best = best


class QuasiStaticInstability(SolverError):
    """A run with M = 0 reached the time beyond which no quasi-static motion exists.

    Attributes
    ----------
    best : xarray.Dataset or None
        From `simulate`, the run up to that time; None from other functions.
    """


class NotConverged(SolverError):
    """No result of the requested accuracy was found.

    Attributes
    ----------
    best : xarray.Dataset or None
        The best estimate so far.
    """


class FitWarning(UserWarning):
    """The result of a fit may be unreliable; the message says why."""


class RecordWarning(UserWarning):
    """A record was read, but rows were left out or look odd; the message says which."""


class RunWarning(UserWarning):
    """A run starts exactly in unstable steady sliding, and nothing disturbs it."""
