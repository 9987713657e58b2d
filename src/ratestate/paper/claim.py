"""A row of the claims table: what the paper says (claims.toml), and what comes out."""

import dataclasses
import functools
import tomllib
from pathlib import Path

TIGHT, LOOSE = 1e-10, 1e-8  # rtol of the converged values, and of those they are compared with
CLOSED_FORM = "closed form; rounding only"
TWO_RUNS = f"difference between rtol {TIGHT:g} and {LOOSE:g}"


@dataclasses.dataclass(frozen=True, kw_only=True)
class Claim:
    """A claim of the paper as a quantity, with the values that it covers.

    Attributes
    ----------
    id : str
    where : str
        Section and figure of the paper.
    claim : str
        In other words than the paper's.
    paper : str
        The paper's value; empty where it gives none for this law.
    unit : str
        Of all values below; "" for pure numbers.
    converged : tuple of float
        This package's answer; the claim says what several values are.
    error : float
        Estimate of its numerical error, the largest of them.
    error_from : str
        How the error was estimated.
    scheme : dict
        Time step of the paper's scheme, (omega dt, dt [s], ...) -> its values, a tuple of float;
        of several dt, one for each value, or the smallest and the largest.
    covers : tuple of (low, high)
        For each value, the range that the claim covers: a number of the paper to half a unit of
        its last digit, or what a phrase means at its widest.  Empty: the paper gives no value.
    note : str
        The cause of a difference, or what a reader should know of the value.
    """

    id: str
    where: str
    claim: str
    paper: str
    unit: str
    converged: tuple
    error: float
    error_from: str
    scheme: dict = dataclasses.field(default_factory=dict)
    covers: tuple = ()
    note: str = ""

    def holds(self, values):
        """Whether the claim covers these values."""
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


@functools.cache
def statements():
    """id -> what the paper says, in the order of the paper."""
    return tomllib.loads(Path(__file__).with_name("claims.toml").read_text("utf-8"))


def claim(name, law, measured):
    """The `Claim` of this id.

    Parameters
    ----------
    name : str
    law : {"slip", "aging"}
    measured : dict
        Fields of `Claim` that a measurement gives, and ``texts``: what stands in the statement's
        braces.
    """
    statement = statements()[name]
    texts = measured.get("texts", {})
    values = {field: value for field, value in measured.items() if field != "texts"}
    silent = statement.get("slip_only", False) and law != "slip"
    covers = [to_digits(*one) for one in statement.get("digits", [])] + statement.get("ranges", [])
    if len(covers) == 1:
        covers *= len(measured["converged"])
    return Claim(
        id=name,
        where=statement["where"],
        claim=statement["claim"].format(**texts),
        paper="" if silent else statement["paper"],
        unit=statement.get("unit", ""),
        covers=() if silent else tuple(map(tuple, covers)),
        note=statement.get("note", "").format(**texts),
        **values,
    )


def pair(measure, *args):
    """A measure at the tight tolerance, and by how much the loose one moves it.

    measure : function of (*args, rtol=...) that gives a tuple of float
    """
    best, other = measure(*args, rtol=TIGHT), measure(*args, rtol=LOOSE)
    return {
        "converged": best,
        "error": max(abs(x - y) for x, y in zip(best, other, strict=True)),
        "error_from": TWO_RUNS,
    }


def exact(*values):
    """Values of closed forms."""
    error = max(abs(value) for value in values) * 1e-14
    return {"converged": values, "error": error, "error_from": CLOSED_FORM}


def to_digits(value, last):
    """The range of values that print as `value` to a last digit of size `last`."""
    return (value - last / 2, value + last / 2)
