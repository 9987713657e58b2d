"""The slider: rigid, of one state variable, on a spring."""

import dataclasses
from typing import Any

from ..errors import ParameterError
from ..friction.laws import evolution_law
from ..friction.stability import K_c, K_c_qs, V_c, eta, f_n
from .arrays import check_aligned
from .quantities import QUANTITIES
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
        Stiffness of the spring per area [Pa/m], > 0.  inf is the rigid limit: V = V_lp.
    M : float, str or DataArray
        Mass per area [kg/m^2], >= 0.  0 (the default) is the quasi-static limit.
    mu0 : float or DataArray
        Friction coefficient in steady sliding at V0 [1], >= 0.
    V0 : float, str or DataArray
        Reference velocity [m/s], > 0.
    law : {"slip", "aging"}
        Evolution law: "slip" (Ruina, eq. 3) or "aging" (Dieterich, eq. 2).

    Raises
    ------
    ParameterError
        A value of a wrong type, unit or range, an unknown law, or arrays that clash.

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

    def __post_init__(self):
        evolution_law(self.law)
        for symbol, value in self.values.items():
            object.__setattr__(self, symbol, to_si(symbol, value))
        check_aligned(self.parameters)

    @property
    def parameters(self):
        """All parameters, symbol -> value, with which to build the slider again."""
        return {field.name: getattr(self, field.name) for field in dataclasses.fields(self)}

    def replace(self, **changes):
        """A slider with some parameters changed, and checked like any other.

        Parameters
        ----------
        **changes
            New values of parameters, as for `SpringSlider`.

        Returns
        -------
        SpringSlider
            The new slider; this one stays as it is.

        Raises
        ------
        ParameterError
            A value of a wrong unit or range.
        """
        return dataclasses.replace(self, **changes)

    @property
    def values(self):
        """The parameters that are quantities: `parameters` but for the law."""
        return {symbol: getattr(self, symbol) for symbol in PARAMETERS}

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

    def __eq__(self, other):
        """Whether all values, and the coordinates of arrays, are equal."""
        if not isinstance(other, SpringSlider):
            return NotImplemented
        pairs = zip(self.parameters.values(), other.parameters.values(), strict=True)
        return all(
            is_array(x) == is_array(y) and (x.equals(y) if is_array(x) else x == y)
            for x, y in pairs
        )

    def __hash__(self):
        return hash(tuple(v.shape if is_array(v) else v for v in self.parameters.values()))


#: symbols of the parameters that are quantities: a, b, Dc, sigma, K, M, mu0, V0
PARAMETERS = tuple(f.name for f in dataclasses.fields(SpringSlider) if f.name != "law")


def checked(slider):
    """The slider; ParameterError if it is none."""
    if not isinstance(slider, SpringSlider):
        raise ParameterError(f"slider = {slider!r} is not a SpringSlider")
    return slider


def _show(symbol, value):
    unit = "" if symbol == "law" else QUANTITIES[symbol].unit
    unit = "" if unit in ("", "1") else f" {unit}"
    if is_array(value):
        sizes = ", ".join(f"{dim}: {size}" for dim, size in value.sizes.items())
        return f"<{sizes}; {float(value.min()):.6g} to {float(value.max()):.6g}{unit}>"
    if not unit:
        return repr(value)
    return repr((f"{value:g}" if float(f"{value:g}") == value else repr(value)) + unit)
