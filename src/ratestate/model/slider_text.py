"""A slider as text: the call that makes it again, and a table for notebooks."""

from html import escape

from ..friction.law import LOG
from .quantities import QUANTITIES, exact, readable, readable_range
from .units import is_array


def as_call(parameters):
    """The call that builds the slider with these parameters; of an array, its sizes and range."""
    shown = (f"{symbol}={_show(symbol, value)}" for symbol, value in parameters.items())
    return f"SpringSlider({', '.join(shown)})"


def as_html(values, law, friction):
    """A table in HTML: symbol, name, and value in a unit that fits; law, friction : their names."""
    rows = [(s, QUANTITIES[s].long_name, _rounded(s, x)) for s, x in values.items()]
    rows.append(("law", "friction law", law))
    rows += [("friction", "form of friction", friction)] if friction != LOG else []
    lines = ("".join(f"<td>{escape(text)}</td>" for text in row) for row in rows)
    body = "".join(f"<tr>{line}</tr>" for line in lines)
    head = "<tr><th></th><th>SpringSlider</th><th>value</th></tr>"
    return f"<table><thead>{head}</thead><tbody>{body}</tbody></table>"


def _rounded(symbol, value):
    """A quantity as text in six digits, or an array's sizes and range."""
    return _sizes_and_range(symbol, value) if is_array(value) else readable(symbol, value, 6)


def _sizes_and_range(symbol, value):
    sizes = ", ".join(f"{dim}: {size}" for dim, size in value.sizes.items())
    return f"<{sizes}; {readable_range(symbol, float(value.min()), float(value.max()))}>"


def _show(symbol, value):
    """A parameter in the call that makes it again; of an array, its sizes and range."""
    if is_array(value):
        return _sizes_and_range(symbol, value)
    if symbol in ("law", "friction"):
        return repr(value)
    text = exact(symbol, value)
    return text if QUANTITIES[symbol].unit == "1" else repr(text)
