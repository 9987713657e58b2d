"""Attributes of results as text and JSON; anybody can lose or change them."""

import json

from .refusals import refusal


def text(result, name, default=None):
    """Return an attribute that is a text, or the default if it is missing.

    Raises ParameterError if it is missing and there is no default, and if it is not a text.
    """
    value = result.attrs.get(name, default)
    if value is None:
        raise refusal("attributes.lost", name=name)
    if not isinstance(value, str):
        raise refusal("attributes.altered", name=name)
    return value


def from_json(result, name, kind=object):
    """Return the value of an attribute that is JSON text.

    Raises ParameterError if it is missing, if it is not JSON, or if it is not of this kind, a type
    such as dict or list.
    """
    written = text(result, name)
    try:
        value = json.loads(written)
    except (ValueError, RecursionError):
        value = None
    if value is None or not isinstance(value, kind):
        raise refusal("attributes.altered", name=name)
    return value
