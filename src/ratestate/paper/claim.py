"""A row of the claims table: a claim of the paper (claims.toml) and the measured values."""

import dataclasses
from pathlib import Path

import numpy as np

from .. import Loading, simulate
from ..model.names import Sentences
from .scheme import step_response, time_step

TIGHT, LOOSE = 1e-10, 1e-8  # rtol of the converged values, and of those they are compared with
CLOSED_FORM = "closed form; rounding only"
SENTENCES = Sentences(Path(__file__).with_name("claims.toml"))


@dataclasses.dataclass(frozen=True, kw_only=True)
class Claim:
    """A claim of the paper as a quantity, with the values that it covers."""

    id: str
    where: str  # section and figure of the paper
    claim: str  # in other words than the paper's
    paper: str  # its value; empty where it gives none for this law
    unit: str  # of all values below; "" for pure numbers
    converged: tuple  # this package's answer; the claim says what several values are
    error: float  # estimate of its numerical error, the largest of them
    error_from: str  # how the error was estimated
    #: Time step of the paper's scheme, (omega dt, dt [s], ...) -> its values, a tuple of float; of
    #: several dt, one for each value, or the smallest and the largest.
    scheme: dict = dataclasses.field(default_factory=dict)
    #: For each value, the range (low, high) that the claim covers: a number of the paper to half a
    #: unit of its last digit, or what a phrase means at its widest.  Empty: the paper gives none.
    covers: tuple = ()
    note: str = ""  # the cause of a difference, or what a reader should know of the value

    def holds(self, values):
        """Return whether the claim covers these values, ends included."""
        pairs = zip(values, self.covers, strict=True)
        return all(low <= value <= high for value, (low, high) in pairs)

    @property
    def verdict(self):
        """One of "agrees", "agrees with the scheme only", "differs" and "no value given"."""
        if not self.covers:
            return "no value given"
        if self.holds(self.converged):
            return "agrees"
        if any(self.holds(values) for values in self.scheme.values()):
            return "agrees with the scheme only"
        return "differs"


def statements():
    """Return what the paper says, id -> table of claims.toml, in the order of the paper."""
    return SENTENCES.tables["claims"]


def claim(name, law, measured):
    """Return the `Claim` of this id, without the paper's value if it is for another law only.

    measured : dict of measured fields of `Claim`, and ``texts`` for the statement's braces
    """
    statement, measured = statements()[name], dict(measured)
    texts = measured.pop("texts", {})
    silent = statement.get("slip_only", False) and law != "slip"
    covers = [to_digits(*row) for row in statement.get("digits", [])] + statement.get("ranges", [])
    if len(covers) == 1:
        covers *= len(measured["converged"])
    return Claim(
        id=name,
        where=statement["where"],
        claim=statement["claim"].format(**texts),
        paper="" if silent else statement["paper"],
        unit=statement.get("unit", ""),
        covers=() if silent else tuple(map(tuple, covers)),
        note=statement.get(f"note_{law}", statement.get("note", "")).format(**texts),
        **measured,
    )


def to_digits(value, last):
    """Return (low, high) of the values that print as `value` to a last digit of size `last`."""
    return (value - last / 2, value + last / 2)


def floats(values):
    """Return a number, or several, as a tuple of float."""
    return tuple(np.atleast_1d(values).astype(float).tolist())


def pair(measure, tight=TIGHT, loose=LOOSE):
    """Return measure(rtol) at the tight tolerance, and its difference from the loose one.

    They are ``converged``, ``error`` and ``error_from`` of `Claim`, in the unit of the measure.
    """
    best, other = floats(measure(tight)), floats(measure(loose))
    return {
        "converged": best,
        "error": max(abs(x - y) for x, y in zip(best, other, strict=True)),
        "error_from": f"difference between rtol {tight:g} and {loose:g}",
    }


def exact(*values):
    """Return the same dict as `pair` for closed forms, with an error of 1e-14 of the largest."""
    error = max(abs(value) for value in values) * 1e-14
    return {"converged": values, "error": error, "error_from": CLOSED_FORM}


def by_scheme(measure, slider, *omega_dts):
    """Return ``scheme`` of `Claim`, from measure(omega dt) by the paper's scheme."""
    steps = {od: (od, time_step(slider, od)) for od in omega_dts}
    return {"scheme": {step: floats(measure(od)) for od, step in steps.items()}}


def after_step(measure, slider, V_start, V_lp, duration, last, omega_dts, times=None):
    """Return measure(run) of the last seconds after a step, converged and by the scheme.

    duration, last, times : [s] since the step, at its end, and of saving (the solver's by default)
    """

    def converged(rtol):
        settings = {"V_start": V_start, "times": times, "rtol": rtol}
        run = simulate(slider, Loading.constant(V_lp), duration, **settings)
        return measure(run.sel(time=slice(duration - last, None)))

    def of_scheme(omega_dt):
        return measure(step_response(slider, V_start, V_lp, duration, omega_dt, last=last))

    return pair(converged) | by_scheme(of_scheme, slider, *omega_dts)
