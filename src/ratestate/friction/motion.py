"""The equations of motion under a law as expressions, in the variables that the engine integrates.

    dx/dT = kappa (w_lp - w),    dv/dT = g/(eta0 c) - sum_k s_k f_k,    d psi_k/dT = f_k

with g = x - S, and w, c and s_k of `kinematics`: if slip never reverses, c is w and the s_k are 0.
With s = sigma(t)/sigma(0), if normal stress varies, and damping,

    S = N + zeta w,     N = s R + (s - 1) mu_ref/a,     R = (mu - mu_ref)/a.

Derivatives are along directions (x, omega, psi), with d omega = dw/c: those by omega are at
constant psi, and those by psi at constant w.
"""

import functools

import numpy as np

from .functions import log, where
from .rewriting import Derivative, function_of
from .tuples import dot

#: symbols of numbers, beside the state and what follows from it
NUMBERS = "x", "g", "F", "q", "m", "moves", "kappa"


class Motion:
    """The equations of motion, and what follows from them: lists of expressions.

    =========================  ==================================================================
    stress, strength           S and N
    resistance, rates          R and f of each state
    g, F                       g, or 0 at rest, and sum_k beta_k f_k: known as numbers
    q, m                       factors of the equation of v, q g + m t F: 1/(eta0 c) and 1, unless
                               the equation is scaled
    moves                      1, or 0 at rest, where w is a constant
    z                          a direction (x, v, psi)
    =========================  ==================================================================
    """

    def __init__(self, law):
        self.law, self.own, self._programs = law, law.equations, {}
        graph = self.graph = self.own.graph
        self.v, self.w, self.psi = self.own.v, self.own.w, self.own.psi
        self.symbols = {name: self._symbol(name) for name in NUMBERS}
        self.z = [self._symbol(("z", k)) for k in range(2 + len(self.psi))]
        places = range(law.n_coefficients)
        changing = law.history(places)
        own = (*self.own.constants,)
        self.p = (*own, *(self._symbol(("p", k), k not in changing) for k in places[len(own) :]))
        R = self.own.resistance[0]
        if law.reverses:
            R = self.v = self._symbol("v")
            self.w, self.c, self.t, self.slope = map(self._symbol, ("w", "c", "t", "slope"))
        N = law.strength_of(R, self.p)
        self.resistance, self.strength = [R], [N]
        self.stress = [law.stress_of(N, self.w, self.p)]
        self.rates = [graph.number(f) for f in law.rates_of(tuple(self.own.rates), R, self.p)]

    def _symbol(self, name, is_constant=False):
        return self.graph.symbol(("motion", name), is_constant=is_constant)

    def _along(self, x, omega, psi, has_rates=True):
        """`Derivative` in a direction; without the change of F if not has_rates."""
        known, effects = self.symbols, self.own.effects
        changes = {known["x"]: x, **dict(zip(self.psi, psi, strict=True))}
        change_of_w, growth = known["moves"] * omega, omega
        if self.law.reverses:
            c, t, sigma = self.c, self.t, dot(effects, psi)
            bend, of_v = (1.0 - t) * (1.0 + t), omega + t * sigma
            growth = t * omega - bend * sigma  # of ln c
            of_log = self.slope * omega
            changes |= {self.v: of_v, t: bend * of_v, self.own.v: of_log}
            changes[self.slope] = self.slope * (known["moves"] * growth - of_log)
            changes |= {c: known["moves"] * growth * c, self.w: change_of_w * c}
        else:
            changes |= {self.v: omega, self.w: change_of_w * self.w}
        changes[known["q"]] = -known["moves"] * growth * known["q"]
        along = Derivative(self.graph, changes)
        along.found[known["g"]] = x - along(self.stress[0])
        if self.law.reverses and has_rates:
            along.found[known["F"]] = dot(effects, tuple(map(along, self.rates)))
        return along

    def _basis(self, **how):
        """Derivatives by x, omega and each psi."""
        one, zero, n = self.graph.one, self.graph.number(0.0), 2 + len(self.psi)
        units = ([one if j == k else zero for j in range(n)] for k in range(n))
        return [self._along(x, omega, psi, **how) for x, omega, *psi in units]

    @functools.cached_property
    def _along_z(self):
        x, v, *psi = self.z
        omega = v - self.t * dot(self.own.effects, psi) if self.law.reverses else v
        return self._along(x, omega, psi)

    @functools.cached_property
    def equations(self):
        """What of the equations depends on x, v and psi."""
        known = self.symbols
        of_v = known["q"] * known["g"]
        if self.law.reverses:
            of_v = of_v + known["m"] * self.t * known["F"]
        return [-known["kappa"] * self.w, of_v, *self.rates]

    def _slopes(self, expression):
        _, *basis = self._basis()
        return [along(expression) for along in basis]

    @functools.cached_property
    def resistance_slopes(self):
        """Slopes of R: by omega, and by each of psi."""
        return self._slopes(*self.resistance)

    @functools.cached_property
    def strength_slopes(self):
        """Those of N."""
        return self._slopes(*self.strength)

    @functools.cached_property
    def stress_slopes(self):
        """Those of S."""
        return self._slopes(*self.stress)

    @functools.cached_property
    def rate_slopes(self):
        """Slopes of the rates: by omega, and by the state itself."""
        _, by_omega, *by_psi = self._basis()
        own = [along(f) for along, f in zip(by_psi, self.rates, strict=True)]
        return [*map(by_omega, self.rates), *own]

    @functools.cached_property
    def _in_time(self):
        return Derivative(self.graph, self.law.changes_in_time(self.p))

    @functools.cached_property
    def strength_drift(self):
        """d/dT of N at constant v and psi; () unless normal stress varies."""
        return list(map(self._in_time, self.strength)) if self.law.varies else []

    @functools.cached_property
    def rate_drift(self):
        """d/dT of the rates at constant v and psi; () unless normal stress varies."""
        return list(map(self._in_time, self.rates)) if self.law.varies else []

    @functools.cached_property
    def inertia_slopes(self):
        """Slopes of -(q g + m t F), where F is held: by omega, and by each of psi."""
        _, *basis = self._basis(has_rates=False)
        return [-along(self.equations[1]) for along in basis]

    @functools.cached_property
    def jacobian(self):
        """Rows of derivatives of `equations`: column -> element, unless that is 0."""
        return _rows(self.equations, self._basis())

    @functools.cached_property
    def curvature(self):
        """How `jacobian` changes along z."""
        return _rows(map(self._along_z, self.equations), self._basis())

    @functools.cached_property
    def trace(self):
        """The trace of the Jacobian matrix in x, v and psi."""
        _, by_omega, *_ = self._basis(has_rates=False)
        return [sum(self.rate_slopes[len(self.psi) :], by_omega(self.equations[1]))]

    @functools.cached_property
    def change_of_trace(self):
        """How the trace changes along z."""
        return list(map(self._along_z, self.trace))

    def __call__(self, name, v, w, psi, p, e=None, z=(), moves=1.0, **numbers):
        """Values of one of these lists; rows as dicts.

        e : as of `kinematics`; None if it is not at hand
        z, numbers : values of those of the symbols that the list needs
        """
        known = {self.v: v, self.w: w, **dict(zip(self.psi, psi, strict=True))}
        known |= dict(zip(self.p, p, strict=False)) | dict(zip(self.z, z, strict=False))
        known |= {self.symbols[one]: x for one, x in ({"moves": moves} | numbers).items()}
        if e is not None:
            if self.law.reverses:
                size, c = self.law.size(w), e[0]
                known |= {self.own.v: log(size), self.own.w: size, self.c: c, self.t: w / c}
                known[self.slope] = where(w > 0.0, c, -c) / size
            known |= dict(zip(self.own.exponentials, e[self.law.reverses :], strict=True))
        found = getattr(self, name)
        flat = [x for row in found for x in row.values()] if _has_rows(found) else found
        key = name, e is None, len(p)
        if key not in self._programs:
            self._programs[key] = function_of(flat, known)
        with np.errstate(all="ignore"):  # the side of a choice that is not taken may be no number
            values = iter(self._programs[key](*known.values()))
        if not _has_rows(found):
            return tuple(values)
        return [{j: next(values) for j in row} for row in found]


def _has_rows(found):
    return bool(found) and isinstance(found[0], dict)


def _rows(equations, basis):
    """Derivatives of each equation, column -> element, but for those that are 0."""
    rows = []
    for one in equations:
        row = {j: along(one) for j, along in enumerate(basis)}
        rows.append({j: x for j, x in row.items() if x is not x.graph.number(0.0)})
    return rows


def product(rows, k):
    """The product of a matrix as `Motion` gives it and a vector, a tuple."""
    return tuple(dot(tuple(row.values()), tuple(k[j] for j in row)) for row in rows)
