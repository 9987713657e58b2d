"""The parameters of a slider: names under each law, conversion, change, equality, printing."""

import dataclasses
import functools
from html import escape
from typing import Any

import numpy as np

from ..errors import ParameterError
from ..friction.composition import composed, form_of
from ..friction.forms import forms_with, parameters_of
from ..friction.law_formula import LOG
from ..friction.laws import DEFAULT, friction_law, laws_with
from .arrays import check_aligned
from .names import check_keywords, check_required, refusal
from .parameters import parameter_to_si
from .quantities import QUANTITIES, exact_text, readable, readable_together
from .units import is_array, is_plain_array
from .user_laws import register, register_source, source_of_law


def resolve_law(law):
    """Return the law with a name or synonym; register and return a user's class."""
    return friction_law(register(law) if isinstance(law, type) else law)


def _check_names_first(init):
    """Wrap `__init__` so that unknown parameters are reported before missing ones."""

    @functools.wraps(init)
    def checked(self, *args, **given):
        law = resolve_law(given.get("law", DEFAULT))
        _check_names(type(self), law, form_of(law, given.get("friction_form")), given)
        if not args:
            check_required("SpringSlider", given, REQUIRED, "{}=...")
        init(self, *args, **(given | {"law": law.name}))

    return checked


@dataclasses.dataclass(frozen=True, kw_only=True, init=False, eq=False, repr=False)
class SliderParameters:
    """Base class of `SpringSlider`: its parameters."""

    a: Any
    b: Any
    Dc: Any
    sigma: Any
    K: Any
    M: Any = 0.0
    mu0: Any = 0.6
    V0: Any = 1e-6
    law: str = DEFAULT
    friction_form: str = LOG
    damping: Any = 0.0
    alpha: Any = 0.0
    area: Any = None

    @_check_names_first
    def __init__(
        self,
        *,
        a,
        b,
        Dc,
        sigma,
        K,
        M=0.0,
        mu0=0.6,
        V0=1e-6,
        law=DEFAULT,
        friction_form=None,
        damping=0.0,
        alpha=0.0,
        area=None,
        **of_law,
    ):
        base_law = friction_law(law)
        common = {"a": a, "b": b, "Dc": Dc, "sigma": sigma, "K": K, "M": M, "mu0": mu0, "V0": V0}
        area = {} if area is None else {"area": area}
        given: dict[str, Any] = {}  # area and sigma come first: others may need them
        optional = {"damping": damping, "alpha": alpha}
        plain = [s for s, x in (area | common | of_law | optional).items() if is_plain_array(x)]
        if len(plain) > 1:
            raise refusal("slider.plain_arrays", names=" and ".join(plain), first=plain[0])
        for symbol, value in (area | common | of_law | optional).items():
            given[symbol] = parameter_to_si(symbol, value, given)
        form = form_of(base_law, friction_form)
        composed(base_law, form)  # raises ParameterError if they cannot be combined
        names = {"law": base_law.name, "friction_form": form, "area": None}
        for name, value in (names | given).items():
            object.__setattr__(self, name, value)
        check_aligned(self.parameters)
        if complaint := base_law.complaint(self):
            raise ParameterError(*complaint, symbol="law", value=repr(base_law.name))
        if self.has_alpha and np.any(np.equal(self.b, 0.0)):
            raise refusal("slider.alpha")

    @property
    def parameters(self):
        """All parameters (symbol -> value), from which the slider can be built again.

        Area, damping, alpha and the form of friction are left out if they have their defaults.
        """
        area = ["area"] if self.has_area else []
        form = ["friction_form"] if self.friction_form != LOG else []
        alpha = ["alpha"] if self.has_alpha else []
        names = (*PARAMETERS, "law", *area, *form, *self.friction_law.parameters, *alpha)
        return {name: getattr(self, name) for name in names}

    @property
    def friction_law(self):
        """The `FrictionLaw` of the slider, with its form of friction and damping."""
        damped = is_array(self.damping) or self.damping != 0.0
        return composed(friction_law(self.law), self.friction_form, damped)

    def replace(self, **changes):
        """Return a slider with some parameters changed.

        Parameters
        ----------
        **changes
            New values of parameters, as for `SpringSlider`.  The other parameters do not change:
            K, M and sigma per area stay the same even if the area changes, and K even if sigma
            changes.  If the law or the form of friction changes, parameters that only the old one
            has are left out.

        Returns
        -------
        SpringSlider
            The new slider.  This slider does not change.

        Raises
        ------
        ParameterError
            If a parameter is unknown or mistyped, or if a value has a wrong unit or range.
        """
        old_law, law = friction_law(self.law), resolve_law(changes.get("law", self.law))
        kept = self.parameters
        if old_law.form != LOG and law != old_law:
            kept.pop("friction_form", None)  # the form belongs to the old law
        form = form_of(law, (kept | changes).get("friction_form"))
        known = {*COMMON, *extra_parameters(law, form)}
        kept = {name: x for name, x in kept.items() if name in known}
        return type(self)(**(kept | changes))

    @property
    def values(self):
        """The `parameters` except the law and form of friction, area first."""
        given = self.parameters
        area = {"area": self.area} if self.has_area else {}
        return area | {name: x for name, x in given.items() if name not in ("law", "friction_form")}

    @property
    def has_area(self):
        """Whether the area of the contact is known, so that forces can be computed."""
        return self.area is not None

    @property
    def has_alpha(self):
        """Whether the state responds to normal stress."""
        return is_array(self.alpha) or self.alpha != 0.0

    def __repr__(self):
        """Return the call that builds the slider, with the sizes and range of an array."""
        shown = (f"{symbol}={_literal(symbol, value)}" for symbol, value in self.parameters.items())
        return f"SpringSlider({', '.join(shown)})"

    def _repr_html_(self):
        """Return an HTML table for notebooks: symbol, name, and value in a suitable unit."""
        rows = [(s, QUANTITIES[s].long_name, _value_text(s, x)) for s, x in self.values.items()]
        rows.append(("law", "friction law", self.law))
        rows += (
            [("friction_form", "form of friction", self.friction_form)]
            if self.friction_form != LOG
            else []
        )
        lines = ("".join(f"<td>{escape(text)}</td>" for text in row) for row in rows)
        body = "".join(f"<tr>{line}</tr>" for line in lines)
        head = "<tr><th></th><th>SpringSlider</th><th>value</th></tr>"
        return f"<table><thead>{head}</thead><tbody>{body}</tbody></table>"

    def __eq__(self, other):
        """Return whether all values, and the coordinates of arrays, are equal."""
        if not isinstance(other, SliderParameters):
            return NotImplemented
        first, second = self.parameters, other.parameters
        return first.keys() == second.keys() and all(
            is_array(x) == is_array(second[name])
            and (x.equals(second[name]) if is_array(x) else x == second[name])
            for name, x in first.items()
        )

    def __reduce__(self):
        """Pickle the source of a user's law too, so that another process can register it."""
        return _rebuild, (type(self), source_of_law(self.law), self.parameters)

    __replace__ = replace  # of `copy.replace`

    def __hash__(self):
        return hash(tuple(v.shape if is_array(v) else v for v in self.parameters.values()))


#: names of the parameters that every slider has
COMMON = tuple(field.name for field in dataclasses.fields(SliderParameters))
#: names of those without a default
REQUIRED = tuple(
    field.name
    for field in dataclasses.fields(SliderParameters)
    if field.default is dataclasses.MISSING
)
#: optional parameter -> its value in sliders that do not have it
OPTIONAL: dict[str, Any] = {"area": None, "friction_form": LOG, "damping": 0.0, "alpha": 0.0}
#: quantities that every motion depends on: a, b, Dc, sigma, K, M, mu0, V0.  Damping and the law's
#: parameters come in addition.
PARAMETERS = tuple(name for name in COMMON if name not in ("law", *OPTIONAL))


def extra_parameters(law, form):
    """Return the parameters of a law and form of friction that are not in `COMMON`."""
    return (*law.parameters, *parameters_of(form))


def _check_names(kind, law, form, given):
    """Raise ParameterError for an unknown or missing parameter of the law and form.

    kind : class of the slider, whose attributes are not names of parameters
    form : name of the form of friction; given : names of the given keywords
    """
    extra = extra_parameters(law, form)
    for name in law.parameters:
        if name in COMMON or hasattr(kind, name):
            raise refusal("slider.common_name", law=law.name, name=name)
    for name in given:
        for kind, chosen, owners in (
            ("law", law.name, laws_with(name)),
            ("friction_form", form, forms_with(name)),
        ):
            if owners and name not in extra:
                of = " and ".join(map(repr, owners))
                raise refusal("slider.other_parameter", kind=kind, chosen=chosen, name=name, of=of)
    check_keywords("SpringSlider", given, (*COMMON, *extra))
    for name in extra:
        if name not in given:
            needing = (
                f"law = {law.name!r}" if name in law.parameters else f"friction_form = {form!r}"
            )
            described = {"long_name": QUANTITIES[name].long_name, "wanted": QUANTITIES[name].remedy}
            raise refusal("slider.missing", needing=needing, name=name, **described)


def _literal(symbol, value):
    """Return a parameter as Python source; for an array, its sizes and range."""
    if is_array(value) or symbol in ("law", "friction_form"):
        return _value_text(symbol, value) if is_array(value) else repr(value)
    text = exact_text(symbol, value)
    return text if QUANTITIES[symbol].unit == "1" else repr(text)


def _value_text(symbol, value):
    """Return a quantity as text with six digits, or the sizes and range of an array."""
    if not is_array(value):
        return readable(symbol, value, 6)
    sizes = ", ".join(f"{dim}: {size}" for dim, size in value.sizes.items())
    ends = float(value.min()), float(value.max())
    return f"<{sizes}; {readable_together(symbol, '{:.6g} to {:.6g}', *ends)}>"


def _rebuild(slider_class, law_source, parameters):
    """Return a slider of this class after registering its law, from `source_of_law`."""
    register_source(law_source)
    return slider_class(**parameters)
