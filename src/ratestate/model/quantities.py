"""The quantities of quantities.toml, the units of units.toml, and values as text."""

import math
import re
import tomllib
from decimal import Decimal
from pathlib import Path
from typing import NamedTuple

from ..friction.forms import FORMS
from ..friction.laws import LAWS


def _read_table(name):
    return tomllib.loads(Path(__file__).with_name(f"{name}.toml").read_text("utf-8")).items()


_UNITS = dict(_read_table("units"))
#: unit -> the name of such a value in messages, and an example
KINDS = {unit: (row["kind"], row["example"]) for unit, row in _UNITS.items()}
#: unit -> powers of ten of the prefixes with which values are shown: 0.0032 m/s as 3.2 mm/s
POWERS = {unit: tuple(row["powers"]) for unit, row in _UNITS.items() if "powers" in row}
#: power of ten -> prefix
PREFIXES = {9: "G", 6: "M", 3: "k", 0: "", -2: "c", -3: "m", -6: "u", -9: "n"}
#: name of a long time -> seconds
LONG_TIMES = {"years": 365.25 * 86400.0, "days": 86400.0, "hours": 3600.0}
#: numbers from 10 to a million in exponential form: 1e+03 is shown as 1000
_SHORT_POWER = re.compile(r"\d(\.\d+)?e\+0[1-5]\b")


class Quantity(NamedTuple):
    """A row of `QUANTITIES`.

    Attributes
    ----------
    unit : str
        SI unit; "1" for a pure number.
    long_name : str
        Name for plots and messages.
    bound : {"", "> 0", ">= 0"}
        Range that `ratestate.to_si` checks.
    example : str
        A value as a user would write it, in quotation marks if it has a unit.
    may_be_inf : bool
        Whether inf is a value.
    """

    unit: str
    long_name: str
    bound: str = ""
    example: str = ""
    may_be_inf: bool = False

    @property
    def remedy(self):
        """The remedy for an unusable value, such as "Give a length such as '10 um'."."""
        return f"Give {KINDS[self.unit][0]} such as {self.example}."

    @property
    def prefixes(self):
        """Prefixes with which values are shown: [(power of ten, prefix), ...], largest first."""
        return [
            (power, prefixed_unit(self.unit, power).removesuffix(self.unit))
            for power in POWERS.get(self.unit, ())
        ]


def quantity(unit, long_name, bound="", example="", may_be_inf=False):
    """Return a `Quantity`; without an example of its own it has the example of its unit."""
    return Quantity(unit, long_name, bound, example or KINDS[unit][1], may_be_inf)


#: symbol -> `Quantity`
QUANTITIES = {symbol: quantity(**row) for symbol, row in _read_table("quantities")}


def add_quantities_of(law):
    """Add the parameters and states of a friction law to `QUANTITIES`."""
    for symbol, parameter in law.parameters.items():
        QUANTITIES[symbol] = quantity(*parameter)
    for k, state in enumerate(law.states):
        QUANTITIES.setdefault(state, quantity("s", f"state {k + 1}", "> 0"))
        QUANTITIES.setdefault(f"{state}_start", quantity("s", f"state {k + 1} at a record's start"))


for _law in LAWS.values():
    add_quantities_of(_law)
for _form in FORMS.values():
    QUANTITIES |= {
        symbol: quantity(*parameter) for symbol, parameter in _form.OWN_PARAMETERS.items()
    }


def attrs(symbol):
    """Return the attributes ``units`` and ``long_name`` of a variable."""
    return {"units": QUANTITIES[symbol].unit, "long_name": QUANTITIES[symbol].long_name}


def power_of(unit, value):
    """Return the largest power of ten of the unit's prefixes up to a value [SI].

    For smaller values, return the lowest power.  Return 0 if a value is below 1e-3 even with the
    smallest prefix, and for a unit that is not in `POWERS`.

    >>> power_of("m/s", 0.0032)
    -3
    """
    powers = POWERS.get(unit, (0,))
    size = abs(value) * (1 + 1e-9)  # rounding to just below 1e-3 does not change the prefix
    lowest = powers[-1] if size >= 10.0 ** (powers[-1] - 3) else 0
    return next((p for p in powers if size >= 10.0**p), lowest)


def prefixed_unit(unit, power, prefixes=PREFIXES):
    """Return an SI unit with the prefix for a power of ten; KeyError if none fits.

    >>> prefixed_unit("m/s", -3), prefixed_unit("m^2", -4)
    ('mm/s', 'cm^2')
    """
    return prefixes[power // 2 if unit == "m^2" else power] + unit


def exact_text(symbol, value):
    """Return a value [SI] with a suitable unit, as text that `to_si` reads exactly.

    A pure number has no unit.  inf, NaN and values without a suitable prefix have the SI unit.

    >>> exact_text("K", 9e8), exact_text("a", 0.003)
    ('900 MPa/m', '0.003')
    """
    unit, x = QUANTITIES[symbol].unit, float(value)
    if unit == "1":
        return repr(x)
    if not math.isfinite(x):
        return f"{x!r} {unit}"
    number = Decimal(repr(x))
    if not number:
        return f"0 {unit}"
    size = number.adjusted()
    fitting = [power for power in POWERS.get(unit, (0,)) if -3 <= size - power <= 5]
    if not fitting:
        return f"{x!r} {unit}"
    power = next((power for power in fitting if power <= size), fitting[-1])
    return f"{number.scaleb(-power).normalize():f} {prefixed_unit(unit, power)}"


def long_time_unit(seconds):
    """Return name and length [s] of the best unit for a time; None below 2 hours."""
    return next((unit for unit in LONG_TIMES.items() if seconds >= 2.0 * unit[1]), None)


def readable(symbol, value, digits=4):
    """Return a value [SI] as text that `ratestate.to_si` reads, with a suitable unit.

    inf, NaN and values that are too small for any prefix have the SI unit.  A pure number has no
    unit.  `ratestate.to_si` refuses NaN.

    Parameters
    ----------
    symbol : str
        Symbol of the quantity, a key of ``ratestate.QUANTITIES``; others raise KeyError.
    value : float
        One value in SI.
    digits : int
        Significant digits.

    Returns
    -------
    str
        The text.

    Examples
    --------
    >>> readable("V_lp", 0.0032)
    '3.2 mm/s'
    >>> readable("t", 1004.0, 3)
    '1000 s'
    """
    return readable_together(symbol, f"{{:.{digits}g}}", value)


def readable_change(symbol, before, after):
    """Return two successive values [SI] of a quantity as text, in a common unit.

    >>> readable_change("V_lp", 3e-6, 1e-5)
    '3 -> 10 um/s'
    """
    return readable_together(symbol, "{:.3g} -> {:.3g}", before, after)


def readable_together(symbol, form, *values):
    """Return values [SI] in a format string, in a unit that suits the largest value."""
    unit, size = QUANTITIES[symbol].unit, max(map(abs, values))
    power = power_of(unit, size) if math.isfinite(size) else 0
    text = form.format(*(value / 10.0**power for value in values))
    text = _SHORT_POWER.sub(lambda found: f"{float(found[0]):.0f}", text)
    return text if unit == "1" else f"{text} {prefixed_unit(unit, power)}"


def readable_time(seconds, digits=4, both=False):
    """Return a time as text, in years, days or hours (or both units) if it is long.

    >>> readable_time(40.0), readable_time(9e6), readable_time(9e6, both=True)
    ('40 s', '104.2 days', '9e+06 s (104 days)')
    """
    if (long := long_time_unit(seconds)) is None:
        return readable("t", seconds, digits)
    unit, length = long
    if both:
        return f"{readable('t', seconds, digits)} ({seconds / length:.3g} {unit})"
    return f"{seconds / length:.{digits}g} {unit}"


def with_error(value, error):
    """Return a value and its standard error as text, rounded as `rounded` does.

    If the error is 0, inf or NaN, return the value alone, with four digits.

    >>> with_error(9.4871, 0.1234), with_error(9.4871, 0.0456), with_error(0.6, 0.0)
    ('9.49 +- 0.12', '9.49 +- 0.05', '0.6')
    """
    if not 0.0 < error < float("inf"):
        return f"{value:.4g}"
    return f"{rounded(value, error)} +- {rounded(error, error)}"


def concise(value, error):
    """Return a value as text, with the standard error of its last digits in brackets.

    If the error is not between 1e-12 and 1e5, return the text of `with_error`.

    >>> concise(9.4871, 0.1234), concise(27.13, 1.3), concise(27.13, 13.0)
    ('9.49(12)', '27.1(13)', '27(13)')
    """
    if not 1e-12 < error < 1e5:
        return with_error(value, error)
    digits = rounded(error, error).replace(".", "").lstrip("0")
    return f"{rounded(value, error)}({digits})"


def rounded(value, error):
    """Return a value as text, rounded to one or two significant digits of its error.

    One digit counts if the error is 3.55 or more times a power of ten, otherwise two.  All digits
    before the point stay.  If the error is not between 1e-12 and 1e5, the text has four digits.

    >>> rounded(9.4871, 0.1234), rounded(9.4871, 0.0456), rounded(152345.6, 1234.5)
    ('9.49', '9.49', '152346')
    """
    if not 1e-12 < error < 1e5:
        return f"{value:.4g}"
    return f"{value:.{max(-math.floor(math.log10(error / 3.55)), 0)}f}"


def short(value):
    """Return a number as text with three digits, or as an integer from 99.5 on.

    >>> short(7.3298), short(11712.4)
    ('7.33', '11712')
    """
    return f"{value:.0f}" if abs(value) >= 99.5 else f"{value:.3g}"


def readable_multiplier(value):
    """Return a Floquet multiplier as text; just below 1, as 1 minus the difference.

    >>> readable_multiplier(0.5 + 0.25j), readable_multiplier(1 - 7e-7)
    ('0.5+0.25i', '1 - 7e-07')
    """
    x, y = value.real, value.imag
    if abs(y) > 1e-12 * abs(value):
        return f"{x:.4g}{y:+.4g}i"
    return f"1 - {1 - x:.3g}" if 0.0 < 1.0 - x < 5e-5 else f"{x:.4g}"
