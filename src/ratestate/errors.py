"""What goes wrong, by name.

::

    RateStateError
    |-- ParameterError   (also a ValueError)    a value, unit or name that cannot be used
    |-- StoreError       (also an OSError)      a store that cannot be made, read or written
    |-- CompilationError (also a RuntimeError)  kernels that cannot be compiled on this machine
    `-- SolverError      (also a RuntimeError)  a run that ended without an answer
        |-- QuasiStaticInstability              M = 0 where no quasi-static solution exists
        `-- NotConverged                        no answer good enough; carries the best estimate

    UserWarning
    |-- FitWarning                              an answer that must not be used unread
    |-- RecordWarning                           rows of a record left out, or odd
    `-- RunWarning                              a run without visible motion, or a slow one
"""


class RateStateError(Exception):
    """Base of every error that ratestate raises on purpose."""


class ParameterError(RateStateError, ValueError):
    """A parameter has a value, unit, shape or name that cannot be used.

    Attributes
    ----------
    sentence : str
        The name of its sentence, ``table.sentence``, where that is kept in a file; else "".
    """

    sentence = ""


class StoreError(RateStateError, OSError):
    """A store of results cannot be made, read or written; nothing that it holds is lost."""


class CompilationError(RateStateError, RuntimeError):
    """A kernel cannot be compiled on this machine, which is no fault of any case."""


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
        From `simulate`, the run up to that time.
    """


class NotConverged(SolverError):
    """No answer good enough was found.

    Attributes
    ----------
    best : xarray.Dataset or None
        The best estimate so far.
    """


class FitWarning(UserWarning):
    """A fit has an answer that must not be used without reading this."""


class RecordWarning(UserWarning):
    """A record was read, but rows were left out or look odd; the message says which."""


class RunWarning(UserWarning):
    """A run starts on unstable steady sliding undisturbed, or takes a law that is slow."""
