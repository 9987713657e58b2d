"""The numbers of a slider that say when steady sliding is stable."""

from typing import Any

from ..errors import ParameterError
from ..friction.composition import JOINT
from ..friction.critical_speeds import V_c
from ..friction.elementwise import call_elementwise
from ..friction.linear_stability import K_c
from ..friction.stability import eta, f_n
from .arrays import check_aligned
from .units import named, to_si


class CriticalNumbers:
    """What `SpringSlider` knows of its stability, from its parameters and its friction law."""

    law: str
    sigma: Any
    parameters: Any
    friction_law: Any

    @property
    def K_c_qs(self):
        """Quasi-static critical stiffness [Pa/m], where all sizes of M are 0; (b - a) sigma/Dc.

        ParameterError where it depends on the speed, as with damping, cut-offs or a law with a
        speed of its own.
        """
        if self.friction_law.has_own_speed:
            parts = self.friction_law.name.split(JOINT)[1:]
            cause = f"with {' and '.join(parts)}" if parts else f"under the law {self.law!r}"
            raise ParameterError(
                f"{cause} K_c_qs depends on the speed; "
                f"stability(slider, V_lp).K_c_qs is that at V_lp"
            )
        return self._of_law("K_c_qs", K_c, V=1.0, M=0.0, sigma=self.sigma)

    @property
    def V_c(self):
        """Critical velocity [m/s] (eq. 10): the lowest above which steady sliding is unstable.

        0 where it is unstable down to rest, inf where at no speed.
        """
        return self._of_law("V_c", V_c, "V_c", **self._pick(("sigma", "K", "M")))

    @property
    def V_c_upper(self):
        """The speed [m/s] above V_c from which steady sliding is stable again; inf if none.

        Under a law with a speed of its own it may become unstable once more at larger speeds.
        """
        return self._of_law("V_c_upper", V_c, "V_c_upper", **self._pick(("sigma", "K", "M")))

    @property
    def f_n(self):
        """Natural frequency [Hz], sqrt(K/M)/(2 pi); inf where there is none (M = 0, K = inf)."""
        return named("f_n", f_n(**self._pick(("K", "M"))))

    def K_c(self, V):
        """Critical stiffness for sliding at V (eq. 6): the largest at which stability changes.

        Steady sliding is unstable just below it, and stable at any K where K_c <= 0.

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
        return self._of_law("K_c", K_c, V=self._speed(V), **self._pick(("sigma", "M")))

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
        return named("eta", eta(self._speed(V), **self._pick(("a", "Dc", "sigma", "M"))))

    def _of_law(self, symbol, function, part=None, **given):
        """The result of a function of linear stability, or a part of it, under its symbol."""
        values = given | self._pick(self.friction_law.symbols)

        def of_arrays(**arrays):
            result = function(self.friction_law, **arrays)
            return result if part is None else getattr(result, part)

        return named(symbol, call_elementwise(of_arrays, values))

    def _pick(self, symbols):
        return {symbol: getattr(self, symbol) for symbol in symbols}

    def _speed(self, V):
        V = to_si("V", V)
        check_aligned({**self.parameters, "V": V})
        return V
