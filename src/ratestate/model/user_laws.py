"""The function `register`: a friction law of one's own, checked and made known."""

import keyword
import os

from ..errors import ParameterError
from ..friction import laws
from ..friction.expressions import FormulaError
from ..friction.law_formula import HASH_MARK
from ..friction.user_law import (
    USER_ERRORS,
    check_formulas,
    class_from_file,
    class_from_text,
    describe_error,
    make_user_law,
    reason_of,
)
from .quantities import KINDS, QUANTITIES, Quantity, add_quantities_of
from .units import to_si

#: words that sliders, scenario files and results use for other things than quantities
RESERVED_NAMES = frozenset(
    "law law_file area values parameters friction replace slider loading method verb file plot"
    " steps times initial parameter start stop point case columns units".split()
)


def register(law):
    """Check a friction law of your own, and make it known by its name.

    Parameters
    ----------
    law : type or path
        A class that derives from `ratestate.FrictionLaw`, with the method
        ``evolution(self, V, theta, p)``, or a Python file with one such class, which is run.

    Returns
    -------
    str
        Its name with the first digits of a hash of its formula, such as "mine@1f6ac03b": results
        have it under this name.  Sliders take this name, the class, or the law's own name, "mine",
        which stands for the law registered last.

    Raises
    ------
    ParameterError
        A file that cannot be read or run, or does not hold one law; a name that a built-in law
        has; a parameter of a name or unit that cannot be; a formula that cannot be run with
        expressions, or gives no finite numbers; a state that depends on another; no steady
        sliding, or several.

    Examples
    --------
    >>> import ratestate as rs
    >>> class Mine(rs.FrictionLaw):
    ...     name = "mine"
    ...     def evolution(self, V, theta, p):
    ...         return 1.0 - (V * theta / p.Dc) ** 1.5
    >>> rs.register(Mine).partition("@")[0]
    'mine'
    """
    law_class = class_from_file(law) if isinstance(law, str | os.PathLike) else law
    try:
        new = make_user_law(law_class)
    except ParameterError:
        raise
    except USER_ERRORS as error:
        raise ParameterError(f"law{_origin(law)} cannot be made: {reason_of(error)}") from error
    own = new.name.partition(HASH_MARK)[0]
    if new.name in laws.LAWS:
        laws.add(new, own)
        return new.name
    try:
        _check_names(new, own)
        check_formulas(new, {symbol: _example(symbol, new) for symbol in new.parameters})
    except ParameterError as error:
        raise ParameterError(f"law {own!r}{_origin(law)}: {error}") from None
    except FormulaError as error:
        raise ParameterError(describe_error(own, new, error)) from None
    except USER_ERRORS as error:
        raise ParameterError(
            f"law {own!r}{_origin(law)} cannot be tried: {reason_of(error)}"
        ) from error
    add_quantities_of(new)
    laws.add(new, own)
    return new.name


def _origin(law):
    """Where a law came from, in messages; "" of a class."""
    return "" if isinstance(law, type) else f" of {law}"


def _check_names(law, own):
    """Raise ParameterError for a name that is taken, and a quantity that cannot be."""
    for name in (own, *law.synonyms):
        known = laws.find_law_name(name)
        if known and HASH_MARK not in known:
            raise ParameterError(f"the name {name!r} is that of a built-in law; choose another")
    for symbol, parameter in law.parameters.items():
        quantity = Quantity(*parameter)
        if not _is_allowed_name(symbol) or _is_other_quantity(symbol, quantity, own):
            raise ParameterError(f"its parameter {symbol!r} is another quantity; rename it")
        if quantity.unit not in KINDS or quantity.bound not in ("", "> 0", ">= 0"):
            units = ", ".join(KINDS)
            raise ParameterError(
                f"its parameter {symbol} has the unit {quantity.unit!r} and the bound "
                f"{quantity.bound!r}; units are {units}; bounds '', '> 0' and '>= 0'"
            )
    known = {state for one in laws.LAWS.values() for state in one.states}
    for state, (_, distance) in law.states.items():
        if not _is_allowed_name(state) or (state in QUANTITIES and state not in known):
            raise ParameterError(
                f"its state {state!r} is another quantity, or no name; rename it, as to theta2"
            )
        if distance != "Dc" and getattr(law.parameters.get(distance), "unit", "") != "m":
            raise ParameterError(f"its state {state} evolves over {distance!r}, which is no length")


def _is_allowed_name(text):
    """Whether a parameter or state may be called so."""
    return text.isidentifier() and not keyword.iskeyword(text) and text not in RESERVED_NAMES


def _is_other_quantity(symbol, quantity, own):
    """Whether a symbol stands for another quantity, elsewhere than in this law before an edit."""
    having = laws.laws_with(symbol)
    if not having:
        return symbol in QUANTITIES
    others = [name for name in having if name.partition(HASH_MARK)[0] != own]
    known = QUANTITIES[symbol]
    return bool(others) and (known.unit, known.bound) != (quantity.unit, quantity.bound)


def _example(symbol, law):
    """A value of a parameter [SI]: its own example, else 1."""
    quantity = Quantity(*law.parameters[symbol])
    if not quantity.example:
        return 1.0
    before = QUANTITIES.get(symbol)
    QUANTITIES[symbol] = quantity._replace(example="")
    try:
        return to_si(symbol, quantity.example.strip("'\""))
    except ParameterError as error:
        raise ParameterError(f"the example of its parameter {symbol} is wrong: {error}") from None
    finally:
        del QUANTITIES[symbol]
        if before is not None:
            QUANTITIES[symbol] = before


def file_of_law(name):
    """The file from which the law of this name was registered, a Path; None of any other law."""
    return vars(type(laws.LAWS[name])).get("file")


def source_of_law(name):
    """Return a user's law as `register_source` takes it in another process; None if built in."""
    if HASH_MARK not in name:
        return None
    law_class = type(laws.LAWS[name])
    return vars(law_class).get("file_text") or law_class


def register_source(record):
    """Register what `source_of_law` gave: the text of a law file, which is run, or a class."""
    known = (vars(type(law)).get("file_text") or type(law) for law in laws.LAWS.values())
    if record is not None and record not in known:
        register(class_from_text(record, "a law file") if isinstance(record, str) else record)
