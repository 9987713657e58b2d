"""Forms of friction: how it depends on speed and state, beside the logarithms of eq. 1.

A file each, found by itself.  A form is a class that stands before a law of state among the bases
of another (`composition`), and so gives that law another friction.
"""

import importlib
import pkgutil

from ...errors import ParameterError
from ..law import LOG


def _built_in():
    """The forms of this package's files, name -> module."""
    modules = (
        importlib.import_module(f.name) for f in pkgutil.iter_modules(__path__, f"{__name__}.")
    )
    return {module.NAME: module for module in modules}


#: name of a form -> its module, but for that of eq. 1: NAME, OWN, its parameters, and `form_at`, a

FORMS = _built_in()


def form_name(form):
    """The name of a form, in any capitals; ParameterError for an unknown one."""
    name = form.lower() if isinstance(form, str) else None
    if name not in (LOG, *FORMS):
        names = " or ".join(map(repr, (LOG, *FORMS)))
        raise ParameterError(f"friction = {form!r} is unknown; choose {names}")
    return name


def parameters_of(form):
    """symbol -> what it is, of the parameters that a form has, by its name."""
    return FORMS[form].OWN if form in FORMS else {}


def forms_with(symbol):
    """Names of the forms that have this symbol among their parameters, a list."""
    return [name for name, module in FORMS.items() if symbol in module.OWN]
