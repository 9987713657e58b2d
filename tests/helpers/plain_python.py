"""The control as plain Python."""

import numpy as np

from ratestate.engine import dispatch
from ratestate.engine.programs import Program, units_of


class PythonProgram:
    """In place of `programs.Program`."""

    def __init__(self, function, record):
        self.function, self.record = function, record

    def __call__(self, budget):
        with np.errstate(all="ignore"):
            return self.function(self.record, budget)


def copied(x):
    """A record of other arrays that hold the same."""
    if isinstance(x, tuple):
        return type(x)(*map(copied, x))
    return x.copy() if isinstance(x, np.ndarray) else x


def arrays_of(x, name="run"):
    """name -> array, of all arrays of a record."""
    if isinstance(x, np.ndarray):
        return {name: x}
    if x == () or not isinstance(x, tuple):
        return {}
    fields = x._asdict().items()
    return {k: v for key, one in fields for k, v in arrays_of(one, f"{name}.{key}").items()}


class Pairs:
    """Runs each of the first `most` sweeps as machine code and as Python, and compares them.

    Each begins with the same numbers for both.  The compiled control has logarithms of its own, so
    results agree to rounding.

    units : law, kind -> the units that Python calls
    """

    def __init__(self, monkeypatch, units, most=250):
        self.units, self.most, self.sweeps = units, most, 0
        monkeypatch.setattr(dispatch, "Program", self.program)
        monkeypatch.setattr(dispatch, "units_of", self.units_of)

    def units_of(self, law, kind, width):
        self.others = self.units(law, kind)
        return units_of(law, kind, width)

    def program(self, function, record):
        mine = Program(function, record)
        copy = copied(record)._replace(units=self.others)
        other = PythonProgram(function, copy)
        ours, theirs = arrays_of(record), arrays_of(copy)

        def run(budget):
            if self.sweeps >= self.most:
                return mine(budget)
            for _ in range(budget):
                self.sweeps += 1
                for name, array in ours.items():  # as the caller left them
                    theirs[name][...] = array
                ends = mine(1), other(1)
                assert ends[0] == ends[1]
                for name, array in ours.items():
                    np.testing.assert_allclose(
                        theirs[name], array, rtol=4e-16, atol=4e-16, err_msg=name
                    )
                if ends[0] or self.sweeps >= self.most:
                    break
            return ends[0]

        return run
