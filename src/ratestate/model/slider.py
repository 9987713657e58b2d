"""The slider: rigid, on a spring, under a friction law."""

import dataclasses
import functools
from html import escape
from typing import Any

import numpy as np

from ..errors import ParameterError
from ..friction.composition import PART_MARK, composed, form_of
from ..friction.critical_speeds import V_c
from ..friction.forms import forms_with, parameters_of
from ..friction.law_formula import LOG
from ..friction.laws import DEFAULT, friction_law, laws_with
from ..friction.linear_stability import K_c
from ..friction.stability import call_elementwise, eta, f_n
from .arrays import check_aligned
from .names import check_keywords
from .parameters import parameter_to_si
from .quantities import QUANTITIES, exact_text, expected, readable, readable_together
from .units import is_array, named, to_si
from .user_laws import register, register_source, source_of_law


def resolve_law(law):
    """The law with a name or synonym, or a user's class of laws, which is registered.

    ParameterError for any other.
    """
    return friction_law(register(law) if isinstance(law, type) else law)


def _check_names_first(init):
    """The `__init__`, which first refuses wrong names: Python would tell of missing ones."""

    @functools.wraps(init)
    def checked(self, *args, **given):
        law = resolve_law(given.get("law", DEFAULT))
        _check_names(law, form_of(law, given.get("friction")), given)
        init(self, *args, **(given | {"law": law.name}))

    return checked


@dataclasses.dataclass(frozen=True, kw_only=True, init=False, eq=False, repr=False)
class SpringSlider:
    """A slider under rate-and-state friction, pulled through a spring (eqs 1-4).

    M dV/dt = tau - sigma mu - damping V, with tau the stress of the spring.

    Every parameter is a number in SI, a string or pint quantity with a unit, or a named
    xarray.DataArray: arrays broadcast by the names of their dimensions, and so make a sweep.
    Afterwards each attribute is a float or a DataArray, in SI.

    Parameters
    ----------
    a : float or DataArray
        Direct effect [1], > 0.
    b : float or DataArray
        Evolution effect [1]; b > a weakens with velocity.
    Dc : float, str or DataArray
        Critical slip distance [m], > 0.
    sigma : float, str or DataArray
        Normal stress [Pa], > 0; that at t = 0, where the loading changes it.
    K : float, str or DataArray
        Stiffness of the spring per area [Pa/m], > 0.  inf is the rigid limit: V = V_lp.  Also
        friction per length, K/sigma, such as "1e-3/um", which is multiplied by sigma.
    M : float, str or DataArray
        Mass per area [kg/m^2], >= 0.  0 (the default) is the quasi-static limit, with damping the
        quasi-dynamic one.
    mu0 : float or DataArray
        Friction coefficient in steady sliding at V0 [1], >= 0; with cut-offs that at V >> V1 and
        theta << Dc/V2.  Steady friction at V0 is 0.567 b higher under "kato-tullis" (V0 << V_cut),
        and lower under "flash-heating" unless V0 << V_w.
    V0 : float, str or DataArray
        Reference velocity [m/s], > 0.  With cut-offs friction does not depend on it.
    law : str
        Friction law, a name of `ratestate.friction.laws.LAWS` or a synonym, such as "Ruina" (eq. 3)
        or "Dieterich" (eq. 2), in any capitals; the attribute is the law's name.
    friction : {"log", "cut-off", "regularized"}, optional
        How friction depends on speed and state: by the logarithms of eq. 1, as by default; cut off
        at high speeds (V1) and at young states (V2; Okubo 1989); or by an inverse hyperbolic sine
        in their place (Rice & Ben-Zion 1996), which is finite at rest, so that slip may reverse.
        The law "flash-heating" is for the last.
    damping : float, str or DataArray
        Damping [Pa s/m], >= 0, by default 0: of a dashpot beside friction, or by radiated shear
        waves, G/(2 c_s).  With it a slider without mass is quasi-dynamic: it slips, however fast.
    alpha : float or DataArray
        Response of the state to normal stress [1], >= 0, by default 0: theta falls by alpha/b with
        ln sigma (Linker & Dieterich 1992).  It acts where sigma varies: in `frequency_response`,
        and in `simulate` and `fit` under a loading that changes it, by `Loading.sigma_step`, say.
        For all else, `stability` and `limit_cycle` among it, sigma is constant.
    area : float, str or DataArray, optional
        Area of the contact [m^2], > 0.  The motion does not depend on it, but with it sigma, K, M
        and damping may be given for the whole contact [N, N/m, kg, N s/m], and reports and figures
        show forces.
    **of_law : float, str or DataArray
        Parameters that the law, or the form of friction, has beside these, all of them: such as b2
        and Dc2 of "two-state-slip", or V1 and V2 of "cut-off".

    Raises
    ------
    ParameterError
        An unknown or mistyped parameter, one that the law does not have, or one of its own that is
        missing; a value of a wrong type, unit or range, an unknown law or form of friction, or two
        that do not go together; arrays that clash.

    Examples
    --------
    >>> slider = SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", M=3000, K="900 MPa/m")
    >>> round(1e3 * slider.V_c, 3)  # mm/s
    3.162
    """

    a: Any
    b: Any
    Dc: Any
    sigma: Any
    K: Any
    M: Any = 0.0
    mu0: Any = 0.6
    V0: Any = 1e-6
    law: str = DEFAULT
    friction: str = LOG
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
        friction=None,
        damping=0.0,
        alpha=0.0,
        area=None,
        **of_law,
    ):
        base_law = friction_law(law)
        common = {"a": a, "b": b, "Dc": Dc, "sigma": sigma, "K": K, "M": M, "mu0": mu0, "V0": V0}
        area = {} if area is None else {"area": area}
        given: dict[str, Any] = {}  # area and sigma come before what needs them
        optional = {"damping": damping, "alpha": alpha}
        for symbol, value in (area | common | of_law | optional).items():
            given[symbol] = parameter_to_si(symbol, value, given)
        form = form_of(base_law, friction)
        composed(base_law, form)  # (if they do not go together this says so)
        names = {"law": base_law.name, "friction": form, "area": None}
        for name, value in (names | given).items():
            object.__setattr__(self, name, value)
        check_aligned(self.parameters)
        if complaint := base_law.complaint(self):
            raise ParameterError(f"law = {base_law.name!r}: {complaint}")
        if self.has_alpha and np.any(np.equal(self.b, 0.0)):
            raise ParameterError(
                "alpha needs b: theta falls by alpha/b; give another b, or alpha = 0"
            )

    @classmethod
    def of_contact(cls, *, area, mass=None, stiffness, normal_force, **parameters):
        """The slider of a contact whose mass, stiffness and normal force are known as a whole.

        Parameters
        ----------
        area : float, str or DataArray
            Area of the contact [m^2], > 0.
        mass : float, str or DataArray, optional
            Mass [kg], >= 0; by default 0, the quasi-static limit.
        stiffness : float, str or DataArray
            Stiffness of the spring [N/m], > 0.
        normal_force : float, str or DataArray
            Normal force [N], > 0.
        **parameters
            The other parameters of `SpringSlider`: a, b, Dc, mu0, V0, law and those of the law,
            alpha, and damping, which may be given for the whole contact [N s/m] too.

        Returns
        -------
        SpringSlider
            With M, K and sigma per area, and with the area.

        Raises
        ------
        ParameterError
            As from `SpringSlider`.

        Examples
        --------
        >>> slider = SpringSlider.of_contact(area="20 cm^2", mass="6 kg", stiffness="1.8 MN/m",
        ...                                  normal_force="4 kN", a=0.003, b=0.006, Dc="10 um")
        >>> slider.sigma, slider.M, slider.K
        (2000000.0, 3000.0, 900000000.0)
        """
        law = resolve_law(parameters.get("law", DEFAULT))
        own = _own_parameters(law, form_of(law, parameters.get("friction")))
        mass = 0.0 if mass is None else mass
        whole = {"normal_force": normal_force, "stiffness": stiffness, "mass": mass}
        others = [name for name in COMMON if name not in ("sigma", "K", "M")]
        check_keywords("SpringSlider.of_contact", parameters, (*whole, *others, *own))
        given = {"area": to_si("area", area)}
        for symbol, name in zip(("sigma", "K", "M"), whole, strict=True):
            value = parameter_to_si(symbol, whole[name], given, quantity=name, label=name)
            given[symbol] = value
        return cls(**given, **parameters)

    @property
    def parameters(self):
        """All parameters, symbol -> value, with which to build the slider again.

        Without area, damping or alpha, if it has none, and a form of friction that is eq. 1's.
        """
        area = ["area"] if self.has_area else []
        form = ["friction"] if self.friction != LOG else []
        alpha = ["alpha"] if self.has_alpha else []
        names = (*PARAMETERS, "law", *area, *form, *self.friction_law.parameters, *alpha)
        return {name: getattr(self, name) for name in names}

    @property
    def friction_law(self):
        """The friction law itself, of its form and with damping if any: a `FrictionLaw`."""
        damped = is_array(self.damping) or self.damping != 0.0
        return composed(friction_law(self.law), self.friction, damped)

    def replace(self, **changes):
        """A slider with some parameters changed, and checked like any other.

        Parameters
        ----------
        **changes
            New values of parameters, as for `SpringSlider`.  The others stay: K, M and sigma are
            kept per area, whatever they were given as.  With another law, or form of friction, the
            parameters that only the old one has are left out.

        Returns
        -------
        SpringSlider
            The new slider; this one stays as it is.

        Raises
        ------
        ParameterError
            An unknown or mistyped parameter; a value of a wrong unit or range.
        """
        old, law = friction_law(self.law), resolve_law(changes.get("law", self.law))
        kept = self.parameters
        if old.form != LOG and law != old:
            kept.pop("friction", None)  # the old law is for this form
        form = form_of(law, (kept | changes).get("friction"))
        known = {*COMMON, *_own_parameters(law, form)}
        kept = {name: x for name, x in kept.items() if name in known}
        return type(self)(**(kept | changes))

    @property
    def values(self):
        """The parameters that are quantities: `parameters` but for the law, the area first."""
        given = self.parameters
        area = {"area": self.area} if self.has_area else {}
        return area | {name: x for name, x in given.items() if name not in ("law", "friction")}

    @property
    def has_area(self):
        """Whether the area of the contact is known, and so forces are."""
        return self.area is not None

    @property
    def has_alpha(self):
        """Whether its state responds to normal stress."""
        return is_array(self.alpha) or self.alpha != 0.0

    @property
    def K_c_qs(self):
        """Quasi-static critical stiffness [Pa/m], where all sizes of M are 0; (b - a) sigma/Dc.

        ParameterError where it depends on the speed, as with damping, cut-offs or a law with a
        speed of its own.
        """
        if self.friction_law.has_speed_scale:
            parts = self.friction_law.name.split(PART_MARK)[1:]
            cause = f"with {' and '.join(parts)}" if parts else f"under the law {self.law!r}"
            raise ParameterError(
                f"{cause} K_c_qs depends on the speed; "
                f"stability(slider, V_lp).K_c_qs is that at V_lp"
            )
        return self._evaluate("K_c_qs", K_c, V=1.0, M=0.0, sigma=self.sigma)

    @property
    def V_c(self):
        """Critical velocity [m/s] (eq. 10): the lowest above which steady sliding is unstable.

        0 where it is unstable down to rest, inf where at no speed.
        """
        return self._evaluate("V_c", V_c, "V_c", **self._pick("sigma", "K", "M"))

    @property
    def V_c_upper(self):
        """The speed [m/s] above V_c from which steady sliding is stable again; inf if none.

        Under a law with a speed of its own it may become unstable once more at larger speeds.
        """
        return self._evaluate("V_c_upper", V_c, "V_c_upper", **self._pick("sigma", "K", "M"))

    @property
    def f_n(self):
        """Natural frequency [Hz], sqrt(K/M)/(2 pi); inf where there is none (M = 0, K = inf)."""
        return named("f_n", f_n(**self._pick("K", "M")))

    def K_c(self, V):
        """Critical stiffness for sliding at V (eq. 6): the largest at which stability changes.

        Steady sliding is unstable just below it, and stable at any K where K_c <= 0.

        Parameters
        ----------
        V : float, str, pint.Quantity or DataArray
            Slip velocity [m/s], > 0; ParameterError if it clashes with the slider's arrays.

        Returns
        -------
        float or DataArray
            K_c [Pa/m].
        """
        return self._evaluate("K_c", K_c, V=self._speed_in_si(V), **self._pick("sigma", "M"))

    def eta(self, V):
        """Dynamic instability coefficient for sliding at V (eq. 7).

        Parameters
        ----------
        V : float, str, pint.Quantity or DataArray
            Slip velocity [m/s], > 0; ParameterError if it clashes with the slider's arrays.

        Returns
        -------
        float or DataArray
            Coefficient eta [1].
        """
        return named("eta", eta(self._speed_in_si(V), **self._pick("a", "Dc", "sigma", "M")))

    def _evaluate(self, symbol, function, part=None, **given):
        """The result of a function of linear stability, or a part of it, under its symbol."""

        def of_arrays(**arrays):
            result = function(self.friction_law, **arrays)
            return result if part is None else getattr(result, part)

        values = given | self._pick(*self.friction_law.symbols)
        return named(symbol, call_elementwise(of_arrays, values))

    def _pick(self, *symbols):
        return {symbol: getattr(self, symbol) for symbol in symbols}

    def _speed_in_si(self, V):
        V = to_si("V", V)
        check_aligned({**self.parameters, "V": V})
        return V

    def __repr__(self):
        """The call that builds the slider; of an array, its sizes and range."""
        shown = (f"{symbol}={_literal(symbol, value)}" for symbol, value in self.parameters.items())
        return f"SpringSlider({', '.join(shown)})"

    def _repr_html_(self):
        """A table for notebooks: symbol, name, and value in a unit that fits."""
        rows = [(s, QUANTITIES[s].long_name, _value_text(s, x)) for s, x in self.values.items()]
        rows.append(("law", "friction law", self.law))
        rows += [("friction", "form of friction", self.friction)] if self.friction != LOG else []
        lines = ("".join(f"<td>{escape(text)}</td>" for text in row) for row in rows)
        body = "".join(f"<tr>{line}</tr>" for line in lines)
        head = "<tr><th></th><th>SpringSlider</th><th>value</th></tr>"
        return f"<table><thead>{head}</thead><tbody>{body}</tbody></table>"

    def __eq__(self, other):
        """Whether all values, and the coordinates of arrays, are equal."""
        if not isinstance(other, SpringSlider):
            return NotImplemented
        mine, its = self.parameters, other.parameters
        return mine.keys() == its.keys() and all(
            is_array(x) == is_array(its[name])
            and (x.equals(its[name]) if is_array(x) else x == its[name])
            for name, x in mine.items()
        )

    def __reduce__(self):
        """With the source of a user's law, which is registered where the slider is made again."""
        return _rebuild, (type(self), source_of_law(self.law), self.parameters)

    __replace__ = replace  # of `copy.replace`

    def __hash__(self):
        return hash(tuple(v.shape if is_array(v) else v for v in self.parameters.values()))


#: names of the parameters of every slider
COMMON = tuple(field.name for field in dataclasses.fields(SpringSlider))
#: what only some sliders have -> what it is for the others
OPTIONAL: dict[str, Any] = {"area": None, "friction": LOG, "damping": 0.0, "alpha": 0.0}
#: symbols of the quantities that every motion depends on: a, b, Dc, sigma, K, M, mu0, V0; beside
#: them there are those of the law, and damping
PARAMETERS = tuple(name for name in COMMON if name not in ("law", *OPTIONAL))


def _own_parameters(law, form):
    """Symbols of the parameters that the law and its form of friction have beside `COMMON`."""
    return (*law.parameters, *parameters_of(form))


def _check_names(law, form, given):
    """Raise ParameterError for a parameter that the law or its form does not have, or lacks.

    form : the name of the form of friction; given : the names given as keywords
    """
    own = _own_parameters(law, form)
    for name in law.parameters:
        if name in COMMON or hasattr(SpringSlider, name):
            raise ParameterError(
                f"law = {law.name!r} has a parameter {name}, which sliders have of their own; "
                f"rename it"
            )
    for name in given:
        for kind, chosen, owners in (
            ("law", law.name, laws_with(name)),
            ("friction", form, forms_with(name)),
        ):
            if owners and name not in own:
                raise ParameterError(
                    f"{kind} = {chosen!r} has no parameter {name}, which belongs to "
                    f"{' and '.join(map(repr, owners))}; leave {name} out, or choose such a {kind}"
                )
    check_keywords("SpringSlider", given, (*COMMON, *own))
    for name in own:
        if name not in given:
            needing = f"law = {law.name!r}" if name in law.parameters else f"friction = {form!r}"
            raise ParameterError(
                f"{needing} needs {name}, {QUANTITIES[name].long_name}; {expected(name)}"
            )


def _literal(symbol, value):
    """A parameter in the call that makes the slider again; of an array, its sizes and range."""
    if is_array(value) or symbol in ("law", "friction"):
        return _value_text(symbol, value) if is_array(value) else repr(value)
    text = exact_text(symbol, value)
    return text if QUANTITIES[symbol].unit == "1" else repr(text)


def _value_text(symbol, value):
    """A quantity as text in six digits, or an array's sizes and range."""
    if not is_array(value):
        return readable(symbol, value, 6)
    sizes = ", ".join(f"{dim}: {size}" for dim, size in value.sizes.items())
    ends = float(value.min()), float(value.max())
    return f"<{sizes}; {readable_together(symbol, '{:.6g} to {:.6g}', *ends)}>"


def _rebuild(kind, record, parameters):
    """A slider of this class, after the law of `source_of_law` has been made known."""
    register_source(record)
    return kind(**parameters)


def check_slider(slider):
    """The slider; ParameterError if it is none."""
    if not isinstance(slider, SpringSlider):
        raise ParameterError(f"slider = {slider!r} is not a SpringSlider")
    return slider
