"""The engine as plain Python: units and control run as written."""

import numpy as np

from ratestate.engine import dispatch
from ratestate.engine import rows as R
from ratestate.engine.control import IDLE
from ratestate.engine.programs import Program, units_of

#: below this error of a step, in tolerances, it is but rounding
ROUNDING = 1e-4
#: rows, by their number, that are decided by the error of a step
OF_ERROR = [row // R.LANES for row in (R.ERROR, R.MEMORY, R.MEMORY_NEW, R.H, R.H_NEXT)]


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


def leave_out(s, exact, size):
    """Let idle lanes be exact, and what errors decide that are but rounding.

    s, exact : sets of lanes, each of a size
    """
    s, exact = (one.reshape(-1, size // R.LANES, R.LANES) for one in (s, exact))
    case, error = R.CASE // R.LANES, R.ERROR // R.LANES
    np.testing.assert_array_equal(s[:, case], exact[:, case])
    for k, l in np.argwhere(exact[:, case] == IDLE):
        s[k, :, l] = exact[k, :, l]
    for k, l in np.argwhere(exact[:, error] < ROUNDING):
        assert s[k, error, l] < 2.0 * ROUNDING
        s[k, OF_ERROR, l] = exact[k, OF_ERROR, l]


class Pairs:
    """Runs sweeps as machine code and as Python, and compares each `every`th of the first `most`.

    Each begins with the same numbers for both.

    units : law, kind -> the units that Python calls; near : allowed relative difference
    """

    def __init__(self, monkeypatch, units, near, every=1, most=250):
        self.units, self.near, self.every, self.most = units, near, every, most
        self.sweeps = 0
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
                if self.sweeps % self.every:
                    if mine(1):
                        return True
                    continue
                for name, array in ours.items():  # as the caller left them
                    theirs[name][...] = array
                ends = mine(1), other(1)
                assert ends[0] == ends[1]
                leave_out(copy.s, record.s, record.shape.size)
                for name, array in ours.items():
                    if theirs[name].tobytes() != array.tobytes():
                        np.testing.assert_allclose(
                            theirs[name], array, rtol=self.near, atol=self.near, err_msg=name
                        )
                if ends[0] or self.sweeps >= self.most:
                    break
            return ends[0]

        return run
