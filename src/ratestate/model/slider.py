"""The slider: rigid, of one state variable, on a spring."""

import dataclasses
from html import escape
from typing import Any

from ..errors import ParameterError
from ..friction.laws import law_name
from ..friction.stability import K_c, K_c_qs, V_c, eta, f_n
from .arrays import check_aligned
from .contact import parameter_to_si
from .names import check_keywords, keywords_checked
from .quantities import QUANTITIES, exact, readable, readable_range
from .units import is_array, named, to_si


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SpringSlider:
    """A slider under rate-and-state friction, pulled through a spring (eqs 1-4).

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
        Normal stress [Pa], > 0.
    K : float, str or DataArray
        Stiffness of the spring per area [Pa/m], > 0.  inf is the rigid limit: V = V_lp.  Also
        friction per length, K/sigma, such as "1e-3/um", which is multiplied by sigma.
    M : float, str or DataArray
        Mass per area [kg/m^2], >= 0.  0 (the default) is the quasi-static limit.
    mu0 : float or DataArray
        Friction coefficient in steady sliding at V0 [1], >= 0.
    V0 : float, str or DataArray
        Reference velocity [m/s], > 0.
    law : {"slip", "aging"}
        Evolution law: "slip" (Ruina, eq. 3) or "aging" (Dieterich, eq. 2), or by a synonym, in any
        capitals; the attribute is "slip" or "aging".
    area : float, str or DataArray, optional
        Area of the contact [m^2], > 0.  The motion does not depend on it, but with it sigma, K and
        M may be given for the whole contact [N, N/m, kg], and reports and figures show forces.

    Raises
    ------
    ParameterError
        An unknown or mistyped parameter; a value of a wrong type, unit or range, an unknown law,
        or arrays that clash.

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
    law: str = "slip"
    area: Any = None

    def __post_init__(self):
        object.__setattr__(self, "law", law_name(self.law))
        given: dict[str, Any] = {}  # area and sigma come before what needs them
        for symbol, value in self.values.items():
            given[symbol] = parameter_to_si(symbol, value, given)
            object.__setattr__(self, symbol, given[symbol])
        check_aligned(self.parameters)

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
            The other parameters of `SpringSlider`: a, b, Dc, mu0, V0 and law.

        Returns
        -------
        SpringSlider
            With M, K and sigma per area, and with the area.

        Raises
        ------
        ParameterError
            An unknown or mistyped parameter; a value of a wrong type, unit or range; arrays that
            clash.

        Examples
        --------
        >>> slider = SpringSlider.of_contact(area="20 cm^2", mass="6 kg", stiffness="1.8 MN/m",
        ...                                  normal_force="4 kN", a=0.003, b=0.006, Dc="10 um")
        >>> slider.sigma, slider.M, slider.K
        (2000000.0, 3000.0, 900000000.0)
        """
        known = ("area", "mass", "stiffness", "normal_force", "a", "b", "Dc", "mu0", "V0", "law")
        check_keywords("SpringSlider.of_contact", parameters, known)
        mass = 0.0 if mass is None else mass
        whole = {"normal_force": normal_force, "stiffness": stiffness, "mass": mass}
        given = {"area": to_si("area", area)}
        for symbol, name in zip(("sigma", "K", "M"), whole, strict=True):
            value = parameter_to_si(symbol, whole[name], given, quantity=name, label=name)
            given[symbol] = value
        return cls(**given, **parameters)

    @property
    def parameters(self):
        """All parameters, symbol -> value, with which to build the slider again.

        Without the area, if it has none.
        """
        names = [field.name for field in dataclasses.fields(self)]
        return {name: getattr(self, name) for name in names if name != "area" or self.has_area}

    def replace(self, **changes):
        """A slider with some parameters changed, and checked like any other.

        Parameters
        ----------
        **changes
            New values of parameters, as for `SpringSlider`.  The others stay: K, M and sigma are
            kept per area, whatever they were given as.

        Returns
        -------
        SpringSlider
            The new slider; this one stays as it is.

        Raises
        ------
        ParameterError
            An unknown or mistyped parameter; a value of a wrong unit or range.
        """
        return dataclasses.replace(self, **changes)

    @property
    def values(self):
        """The parameters that are quantities: `parameters` but for the law, the area first."""
        symbols = ("area", *PARAMETERS) if self.has_area else PARAMETERS
        return {symbol: getattr(self, symbol) for symbol in symbols}

    @property
    def has_area(self):
        """Whether the area of the contact is known, and so forces are."""
        return self.area is not None

    @property
    def K_c_qs(self):
        """Quasi-static critical stiffness [Pa/m], (b - a) sigma/Dc."""
        return named("K_c_qs", K_c_qs(**self._pick("a b Dc sigma")))

    @property
    def V_c(self):
        """Critical velocity [m/s] (eq. 10): 0 where always unstable, inf where never."""
        return named("V_c", V_c(**self._pick("a b Dc sigma K M")))

    @property
    def f_n(self):
        """Natural frequency [Hz], sqrt(K/M)/(2 pi); inf where there is none (M = 0, K = inf)."""
        return named("f_n", f_n(**self._pick("K M")))

    def K_c(self, V):
        """Critical stiffness for sliding at V (eq. 6): unstable where K < K_c.

        Parameters
        ----------
        V : float, str, pint.Quantity or DataArray
            Slip velocity [m/s], > 0.

        Returns
        -------
        float or DataArray
            K_c [Pa/m].

        Raises
        ------
        ParameterError
            V of a wrong unit or range, or that clashes with the slider's arrays.
        """
        return named("K_c", K_c(self._speed(V), **self._pick("a b Dc sigma M")))

    def eta(self, V):
        """Dynamic instability coefficient for sliding at V (eq. 7).

        Parameters
        ----------
        V : float, str, pint.Quantity or DataArray
            Slip velocity [m/s], > 0.

        Returns
        -------
        float or DataArray
            Coefficient eta [1].

        Raises
        ------
        ParameterError
            V of a wrong unit or range, or that clashes with the slider's arrays.
        """
        return named("eta", eta(self._speed(V), **self._pick("a Dc sigma M")))

    def _pick(self, symbols):
        return {symbol: getattr(self, symbol) for symbol in symbols.split()}

    def _speed(self, V):
        V = to_si("V", V)
        check_aligned({**self.parameters, "V": V})
        return V

    def __repr__(self):
        """The call that builds the slider; of an array, its sizes and range."""
        shown = (f"{symbol}={_show(symbol, v)}" for symbol, v in self.parameters.items())
        return f"SpringSlider({', '.join(shown)})"

    def _repr_html_(self):
        """A table for notebooks: symbol, name, and value in a unit that fits."""
        rows = [(s, QUANTITIES[s].long_name, _rounded(s, x)) for s, x in self.values.items()]
        rows.append(("law", "evolution law", self.law))
        lines = ("".join(f"<td>{escape(text)}</td>" for text in row) for row in rows)
        body = "".join(f"<tr>{line}</tr>" for line in lines)
        head = "<tr><th></th><th>SpringSlider</th><th>value</th></tr>"
        return f"<table><thead>{head}</thead><tbody>{body}</tbody></table>"

    def __eq__(self, other):
        """Whether all values, and the coordinates of arrays, are equal."""
        if not isinstance(other, SpringSlider):
            return NotImplemented
        pairs = ((x, getattr(other, name)) for name, x in self.parameters.items())
        return self.has_area == other.has_area and all(
            is_array(x) == is_array(y) and (x.equals(y) if is_array(x) else x == y)
            for x, y in pairs
        )

    def __hash__(self):
        return hash(tuple(v.shape if is_array(v) else v for v in self.parameters.values()))


# (the dataclass writes its __init__, which nothing else can decorate)
SpringSlider.__init__ = keywords_checked(SpringSlider.__init__)  # type: ignore[method-assign]

#: symbols of the quantities that the motion depends on: a, b, Dc, sigma, K, M, mu0, V0
PARAMETERS = tuple(
    f.name for f in dataclasses.fields(SpringSlider) if f.name not in ("law", "area")
)


def checked(slider):
    """The slider; ParameterError if it is none."""
    if not isinstance(slider, SpringSlider):
        raise ParameterError(f"slider = {slider!r} is not a SpringSlider")
    return slider


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
    if symbol == "law":
        return repr(value)
    text = exact(symbol, value)
    return text if QUANTITIES[symbol].unit == "1" else repr(text)
