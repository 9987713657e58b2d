"""The class `SpringSlider`: a rigid slider on a spring, with a friction law."""

import dataclasses

from ..friction.closed_forms import call_elementwise, eta, f_n
from ..friction.composition import PART_MARK, form_of
from ..friction.critical_speeds import V_c
from ..friction.laws import DEFAULT
from ..friction.linear_stability import K_c
from .arrays import check_aligned
from .names import check_keywords, refusal
from .parameters import WHOLE_CONTACT, parameter_to_si
from .slider_parameters import COMMON, SliderParameters, extra_parameters, resolve_law
from .units import named, to_si


@dataclasses.dataclass(frozen=True, kw_only=True, init=False, eq=False, repr=False)
class SpringSlider(SliderParameters):
    """A slider with rate-and-state friction, pulled through a spring (eqs 1-4).

    The equation of motion is M dV/dt = tau - sigma mu - damping V.  The spring's stress is tau.

    Every parameter is a number in SI, a string or pint quantity with a unit, or an
    xarray.DataArray with named dimensions, whose unit is its attribute ``units`` or SI.  Arrays
    broadcast by the names of their dimensions, which makes a sweep.  One parameter may be a 1-D
    NumPy array; its dimension has the parameter's name.  Attributes and methods give floats in SI,
    or DataArrays with the dimensions of the parameters on which they depend.

    Parameters
    ----------
    a : float or DataArray
        Direct effect [1], > 0.
    b : float or DataArray
        Evolution effect [1].  If b > a, friction weakens with velocity.
    Dc : float, str or DataArray
        Critical slip distance [m], > 0.
    sigma : float, str or DataArray
        Normal stress [Pa], > 0; its value at t = 0 if the loading changes it.
    K : float, str or DataArray
        Stiffness of the spring per area [Pa/m], > 0.  inf is the rigid limit, V = V_lp.  K may also
        be friction per length, such as "1e-3/um".  It is then multiplied by sigma.  If sigma is an
        array too, an axis called K is renamed as K_over_sigma.
    M : float, str or DataArray
        Mass per area [kg/m^2], >= 0.  The default, 0, is the quasi-static limit, or the
        quasi-dynamic limit if there is damping.
    mu0 : float or DataArray
        Friction coefficient in steady sliding at V0 [1], >= 0.  With friction_form="cut-off", it is
        the friction coefficient at V >> V1 and theta << Dc/V2.  Under "kato-tullis" with
        V0 << V_cut, steady friction at V0 is mu0 + 0.567 b, because x = ln(V0 theta/Dc) then solves
        x exp(x) = 1.  Under "flash-heating" it is lower than mu0 unless V0 << V_w.
    V0 : float, str or DataArray
        Reference velocity [m/s], > 0.  With friction_form="cut-off", friction does not depend on
        it.
    law : str
        Friction law: a name in `ratestate.laws.catalogue` or a synonym, such as "Ruina" (eq. 3)
        or "Dieterich" (eq. 2), in upper or lower case.  The attribute is the law's name.
    friction_form : {"log", "cut-off", "regularized"}, optional
        How friction depends on speed and state.  "log", the default, is eq. 1.  With "cut-off"
        friction hardly depends on V above V1, and on theta below Dc/V2 (Okubo 1989).  "regularized"
        replaces the logarithm by an inverse hyperbolic sine (Rice & Ben-Zion 1996): friction is
        finite at rest, and slip may reverse.  The law "flash-heating" uses "regularized".
    damping : float, str or DataArray
        Damping [Pa s/m], >= 0, by default 0: a dashpot parallel to friction, or radiation of shear
        waves.  The latter is G/(2 c_s), with the shear modulus G and the shear-wave speed c_s.  A
        slider with damping and without mass is quasi-dynamic.  Its velocity stays finite.
    alpha : float or DataArray
        Response of the state to normal stress [1], >= 0, by default 0 (Linker & Dieterich 1992):
        ln theta falls by alpha/b times the change of ln sigma.  It matters only if sigma varies: in
        `frequency_response`, and in `simulate` and `fit` with a loading that changes sigma, for
        example by `Loading.sigma_step`.
    area : float, str or DataArray, optional
        Area of the contact [m^2], > 0.  The motion does not depend on it.  If it is given, sigma,
        K, M and damping may be values of the whole contact [N, N/m, kg, N s/m], and reports and
        figures show forces.
    **of_law : float, str or DataArray
        Additional parameters of this law or form of friction, such as b2 and Dc2 of
        "two-state-slip", or V1 and V2 of "cut-off".  All of them are required.

    Raises
    ------
    ParameterError
        If a parameter is unknown or missing, or has a wrong type or unit or a value out of range.
        Also if law and form of friction cannot be combined, or if arrays clash.

    Examples
    --------
    >>> slider = SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", M=3000, K="900 MPa/m")
    >>> round(1e3 * slider.V_c, 3)  # mm/s
    3.162
    """

    @classmethod
    def of_contact(cls, *, area, mass=0.0, stiffness, normal_force, dashpot=None, **parameters):
        """Return a slider from the mass, stiffness and forces of the whole contact.

        Parameters
        ----------
        area : float, str or DataArray
            Area of the contact [m^2], > 0.
        mass : float, str or DataArray, optional
            Mass [kg], >= 0.  The default, 0, is the quasi-static limit.
        stiffness : float, str or DataArray
            Stiffness of the spring [N/m], > 0.
        normal_force : float, str or DataArray
            Normal force [N], > 0.
        dashpot : float, str or DataArray, optional
            Damping [N s/m], >= 0.
        **parameters
            The other parameters of `SpringSlider`: a, b, Dc, mu0, V0, alpha, law and friction_form,
            and the parameters of these two.

        Returns
        -------
        SpringSlider
            The slider, with M, K, sigma and damping per area, and with its area.

        Raises
        ------
        ParameterError
            In the same cases as `SpringSlider`.

        Examples
        --------
        >>> slider = SpringSlider.of_contact(area="20 cm^2", mass="6 kg", stiffness="1.8 MN/m",
        ...                                  normal_force="4 kN", a=0.003, b=0.006, Dc="10 um")
        >>> slider.sigma, slider.M, slider.K
        (2000000.0, 3000.0, 900000000.0)
        """
        law = resolve_law(parameters.get("law", DEFAULT))
        extra = extra_parameters(law, form_of(law, parameters.get("friction_form")))
        contact_values = {"normal_force": normal_force, "stiffness": stiffness, "mass": mass}
        if dashpot is not None:
            contact_values["dashpot"] = dashpot
        others = [name for name in (*COMMON, *extra) if name not in WHOLE_CONTACT.values()]
        check_keywords("SpringSlider.of_contact", parameters, (*WHOLE_CONTACT, *others))
        given = {"area": to_si("area", area)}
        for name, value in contact_values.items():
            symbol = WHOLE_CONTACT[name]
            given[symbol] = parameter_to_si(symbol, value, given, quantity=name, label=name)
        return cls(**given, **parameters)

    @property
    def K_c_qs(self):
        """Quasi-static critical stiffness (M = 0) [Pa/m].

        It is (b - a) sigma/Dc under the aging and slip laws, negative if b < a.  Raises
        ParameterError if it depends on the speed: with damping or cut-offs, and under laws with a
        characteristic speed.
        """
        if self.friction_law.has_speed_scale:
            parts = self.friction_law.name.split(PART_MARK)[1:]
            cause = f"with {' and '.join(parts)}" if parts else f"under the law {self.law!r}"
            raise refusal("slider.K_c_qs", cause=cause)
        return self._evaluate("K_c_qs", K_c, V=1.0, M=0.0, sigma=self.sigma)

    @property
    def V_c(self):
        """Critical velocity [m/s] (eq. 10): steady sliding is unstable just above it.

        It is the lowest such velocity: 0 if steady sliding is unstable at all low velocities, and
        inf if steady sliding is stable at all velocities.
        """
        return self._evaluate("V_c", V_c, "V_c", **self._values_of("sigma", "K", "M"))

    @property
    def V_c_upper(self):
        """Velocity above V_c [m/s] at which steady sliding becomes stable again, or inf.

        It is inf if V_c is inf, and under the slip and aging laws with eq. 1 and without damping.
        Under a law with a characteristic speed, it may become unstable again above V_c_upper.
        """
        return self._evaluate("V_c_upper", V_c, "V_c_upper", **self._values_of("sigma", "K", "M"))

    @property
    def f_n(self):
        """Natural frequency [Hz], sqrt(K/M)/(2 pi); inf if M = 0 or K = inf."""
        return named("f_n", f_n(**self._values_of("K", "M")))

    def K_c(self, V):
        """Return the critical stiffness for sliding at V (eq. 6).

        Steady sliding is unstable at stiffnesses just below K_c and stable at all larger ones.  If
        K_c <= 0, steady sliding is stable at any stiffness.

        Parameters
        ----------
        V : float, str, pint.Quantity or DataArray
            Slip velocity [m/s], > 0.

        Returns
        -------
        float or DataArray
            K_c [Pa/m].
        """
        return self._evaluate("K_c", K_c, V=self._speed_in_si(V), **self._values_of("sigma", "M"))

    def eta(self, V):
        """Return the dynamic instability coefficient for sliding at V (eq. 7).

        Parameters
        ----------
        V : float, str, pint.Quantity or DataArray
            Slip velocity [m/s], > 0.

        Returns
        -------
        float or DataArray
            Coefficient eta [1].
        """
        return named("eta", eta(self._speed_in_si(V), **self._values_of("a", "Dc", "sigma", "M")))

    def steady_stress(self, V):
        """Return tau/sigma in steady sliding at V: friction, and damping if there is any.

        Parameters
        ----------
        V : float, str, pint.Quantity or DataArray
            Slip velocity [m/s], > 0.

        Returns
        -------
        float or DataArray
            tau/sigma [1].
        """

        def of_law(law, V, **values):
            return law.steady_tau(V, values)

        values = self._values_of("sigma", "mu0", "V0")
        return self._evaluate("tau_by_sigma", of_law, V=self._speed_in_si(V), **values)

    def _evaluate(self, symbol, function, part=None, **given):
        """Return the result, or a part of it, of a function of linear stability."""

        def of_arrays(**arrays):
            result = function(self.friction_law, **arrays)
            return result if part is None else getattr(result, part)

        values = given | self._values_of(*self.friction_law.symbols)
        return named(symbol, call_elementwise(of_arrays, values))

    def _values_of(self, *symbols):
        return {symbol: getattr(self, symbol) for symbol in symbols}

    def _speed_in_si(self, V):
        V = to_si("V", V)
        check_aligned({**self.parameters, "V": V})
        return V


def check_slider(slider):
    """Return the slider; ParameterError if it is not a `SpringSlider`."""
    if not isinstance(slider, SpringSlider):
        raise refusal("slider.none", slider=slider)
    return slider
