"""Tools that the evaluations of records share, such as variables and attributes of results."""

from ...model.conversion import in_si
from ...model.quantities import attrs
from ..messages import kit as sentences

#: attributes of a record that results keep
RECORD_ATTRIBUTES = ("source", "columns", "found", "notes")


def kept_attributes(record):
    """Return the attributes of a record that a result keeps."""
    return {name: record.attrs[name] for name in RECORD_ATTRIBUTES if name in record.attrs}


def checked_result(result, function, name):
    """Return a result in SI; raise ParameterError unless it is from this function."""
    title = getattr(result, "attrs", {}).get("title")
    if title != f"ratestate {function}" or name not in result:
        raise sentences.refusal("result.other", function=function)
    return in_si(result)


def labelled(dims, **values):
    """Return name -> variable along one or more dimensions; each name is in `QUANTITIES`.

    A tuple of values and standard errors gives the variables NAME and NAME_error.
    """
    columns: dict = {}
    for name, value in values.items():
        if isinstance(value, tuple):
            columns[name], columns[f"{name}_error"] = value
        else:
            columns[name] = value
    return {name: (dims, value, attrs(name)) for name, value in columns.items()}
