"""The equations of motion under a law, as expressions in the engine's variables.

    dx/dT = kappa (w_lp - w),    dv/dT = g/(eta0 c) - sum_k s_k f_k,    d psi_k/dT = f_k

with g = x - S, and with w, c and s_k from `point`: if slip never reverses, c is w and the s_k
are 0.  With damping, and s = sigma(t)/sigma(0) if normal stress varies,

    S = N + zeta w,     N = s R + (s - 1) mu_ref/a,     R = (mu - mu_ref)/a.

Derivatives are along directions (x, omega, psi), with d omega = dw/c: derivatives by omega are at
constant psi, and derivatives by psi at constant w.
"""

import functools
from typing import Any

from .rewriting import Derivative, values_of
from .taylor import NoSeries
from .tuples import dot

#: symbols of numbers other than the state and its functions
VARYING_SYMBOLS = "x", "w_lp", "g", "F", "q", "moves"
CONSTANT_SYMBOLS = "kappa", "1/eta0", "m", "dT"
#: coefficients before s and its derivatives, if normal stress varies (`composition.Varying`)
HISTORY_SYMBOLS = "base", "rate", "amplitude", "frequency", "phase"


class Motion:
    """The equations of motion and their consequences, lists of expressions by name.

    ============================  ===============================================================
    S, N, R                       stress that opposes motion, strength, resistance
    f                             d psi/dT of each state
    exponents                     arguments of the exponentials in f
    S_slopes, R_slopes            derivatives by omega, and by each psi
    f_slopes                      derivatives of each f by omega; derivatives by its own state
    changes                       changes of S, N and R along z, here a direction (x, omega, psi),
                                  and in a time dT
    N_drift, f_drift              rates in T at constant v and psi; empty if sigma is constant
    inertia_slopes                derivatives of -(q g + m t F) by omega and each psi at constant F
    jacobian                      rows of derivatives of the equations by x, omega and each psi:
                                  column -> element, without zeros
    curvature                     change of `jacobian` along z
    change_of_trace               change along z of the trace of the Jacobian matrix in x, v, psi
    slaved, slaved_slopes         d omega/dT without inertia at a load-point speed of w, and its
                                  derivatives by each psi
    jumps, jump_growth            d psi/d ln s if normal stress varies, and the derivative of ln of
                                  these jumps
    ============================  ===============================================================

    These expressions have the symbols

    ========  ===================================================================================
    g, F      x - S, or 0 at rest, and sum_k beta_k f_k: given as numbers
    q, m      factors of the equation of v, q g + m t F: 1/(eta0 c) and 1, unless it is scaled
    moves     1, or 0 at rest, when w is a constant
    z         a direction (x, v, psi)
    ========  ===================================================================================

    reverses : whether v is friction, so that slip may reverse; else v is ln w
    """

    def __init__(self, law, reverses):
        self.law, self.equations, self.reverses = law, law.equations, reverses
        self.graph = self.equations.graph
        self.v, self.w, self.psi = self.equations.v, self.equations.w, self.equations.psi
        self.symbols = {name: self._symbol(name) for name in VARYING_SYMBOLS}
        self.symbols |= {name: self._symbol(name, is_constant=True) for name in CONSTANT_SYMBOLS}
        self.symbols["z"] = [self._symbol(("z", k)) for k in range(2 + len(self.psi))]
        if reverses:
            self.v, self.w, self.c = map(self._symbol, ("v", "w", "c"))
            self.t, self.slope = map(self._symbol, ("t", "slope"))  # w/c, and d ln |w|/d omega
        self.R = self.v if reverses else self.equations.resistance[0]
        self.N, self.f, self.p = self.R, self.equations.rates, (*self.equations.constants,)
        self.time_rates = {}
        self._lists: dict[str, Any] = {}
        if law.varies:
            self._add_varying_stress()
        self.S = self.N if self.equations.zeta is None else self.N + self.equations.zeta * self.w
        self._lists |= {"S": self.S, "N": self.N, "R": self.R, "f": self.f}
        self._lists["exponents"] = self.equations.exponents
        # the order in which expressions are made is the order of terms in their sums
        self._add_slopes()
        self._add_changes()
        by_omega, *by_psi = self["S_slopes"]
        # friction that does not change with V is refused when its law is tried
        is_flat = by_omega.kind == "number" and by_omega.parts[0] == 0.0
        slaved = -dot(by_psi, self.f) / (self.graph.one if is_flat else by_omega)
        self._lists["slaved"] = slaved
        self._lists["slaved_slopes"] = [derivative(slaved) for derivative in self._basis[2:]]

    def _symbol(self, name, is_constant=False):
        return self.graph.symbol(("motion", name), is_constant=is_constant)

    def _add_varying_stress(self):
        """Add varying normal stress, whose numbers follow the law's own coefficients."""
        n = len(self.psi)
        level, *h = (self._symbol(("p", k), is_constant=True) for k in range(1 + 2 * n))
        s, ds, dds = (self._symbol(name) for name in ("s", "ds", "dds"))
        self.p = (*self.p, level, *h, *map(self._symbol, HISTORY_SYMBOLS), s, ds, dds)
        self.N = s * self.R + (s - 1.0) * level
        self.by_R, self.time_rates, growth = h[n:], {s: ds, ds: dds}, ds / s
        jumps = [h_0 + self.R * h_1 for h_0, h_1 in zip(h[:n], self.by_R, strict=True)]
        self.f = [f + growth * jump for f, jump in zip(self.f, jumps, strict=True)]
        self._lists["jumps"] = jumps

    def _derivative_along(self, x, omega, *psi, with_F=True, dT=0.0):
        """Return a `Derivative` in a direction and a time dT; of F too if with_F."""
        symbols, effects = self.symbols, self.equations.evolution_effects
        changes = {symbols["x"]: x, **dict(zip(self.psi, psi, strict=True))}
        moves = symbols["moves"]
        d_omega, d_log_c = moves * omega, omega
        if self.reverses:
            c, t, d_Theta, d_log_w = self.c, self.t, dot(effects, psi), self.slope * omega
            dt_dv, dv = (1.0 - t) * (1.0 + t), omega + t * d_Theta
            d_log_c = t * omega - dt_dv * d_Theta
            changes |= {self.v: dv, t: dt_dv * dv, self.equations.v: d_log_w}
            changes |= {c: moves * d_log_c * c, self.w: d_omega * c}
            changes[self.slope] = self.slope * (moves * d_log_c - d_log_w)
        else:
            changes |= {self.v: omega, self.w: d_omega * self.w}
        changes[symbols["q"]] = -moves * d_log_c * symbols["q"]
        changes |= {symbol: dT * rate for symbol, rate in self.time_rates.items()}
        derivative = Derivative(self.graph, changes)
        derivative.derivatives[symbols["g"]] = x - derivative(self.S)
        if self.reverses and with_F:
            derivative.derivatives[symbols["F"]] = dot(effects, tuple(map(derivative, self.f)))
        return derivative

    def _add_slopes(self):
        n, zero = 2 + len(self.psi), self.graph.number(0.0)
        self._units = [[self.graph.one if j == k else zero for j in range(n)] for k in range(n)]
        self._basis = [self._derivative_along(*unit) for unit in self._units]
        _, by_omega, *by_psi = self._basis
        by_own_psi = [derivative(f) for derivative, f in zip(by_psi, self.f, strict=True)]
        S, R = ([derivative(force) for derivative in self._basis[1:]] for force in (self.S, self.R))
        f_slopes = [[*map(by_omega, self.f)], by_own_psi]
        self._lists |= {"S_slopes": S, "R_slopes": R, "f_slopes": f_slopes}
        if self.time_rates:
            self._lists["jump_growth"] = dot(R[1:], self.by_R)

    def _add_changes(self):
        symbols, f, (x, v, *psi) = self.symbols, self.f, self.symbols["z"]
        at_constant_F = [self._derivative_along(*unit, with_F=False) for unit in self._units[1:]]
        along_and_time = self._derivative_along(x, v, *psi, dT=symbols["dT"])
        by_time = Derivative(self.graph, self.time_rates)
        v_row, omega = symbols["q"] * symbols["g"], v
        if self.reverses:
            v_row = v_row + symbols["m"] * self.t * symbols["F"]
            omega = v - self.t * dot(self.equations.evolution_effects, psi)
        along_z = self._derivative_along(x, omega, *psi)
        equations = [-symbols["kappa"] * self.w, v_row, *f]
        self._lists |= {
            "changes": [*map(along_and_time, (self.S, self.N, self.R))],
            "N_drift": [by_time(self.N)] if self.time_rates else [],
            "f_drift": [*map(by_time, f)] if self.time_rates else [],
            "inertia_slopes": [-derivative(v_row) for derivative in at_constant_F],
            "jacobian": _rows(equations, self._basis),
            "curvature": _rows(map(along_z, equations), self._basis),
            "change_of_trace": along_z(sum(self["f_slopes"][1], at_constant_F[0](v_row))),
        }

    def __getitem__(self, name):
        return self._lists[name]

    def values(self, name, inputs):
        """Return the values of one of the lists of expressions, in its shape.

        A single expression gives a number, a list a tuple, rows a tuple of tuples or dicts.

        inputs : expression of a symbol -> value; w and exponentials too if they are known
        """
        return _refill(self[name], iter(values_of(_flatten(self[name]), inputs)))

    @functools.cached_property
    def in_time(self):
        """Return x, v, psi -> derivative in T, and a list of the powers of `Point.work_rates`.

        NoSeries if slip may reverse or normal stress varies.
        """
        if self.reverses or self.time_rates:
            raise NoSeries("slip that may reverse, or normal stress that varies")
        x, w_lp, kappa, inverse = (self.symbols[name] for name in ("x", "w_lp", "kappa", "1/eta0"))
        of_x_and_v = kappa * (w_lp - self.w), inverse * (x - self.S) / self.w
        derivatives = zip((x, self.v, *self.psi), (*of_x_and_v, *self.f), strict=True)
        return dict(derivatives), [x * w_lp, self.S * self.w]


def _rows(equations, basis):
    """Return the derivatives of each equation, column -> element, without zeros."""
    rows = []
    for equation in equations:
        row = {j: derivative(equation) for j, derivative in enumerate(basis)}
        rows.append({j: x for j, x in row.items() if x is not x.graph.number(0.0)})
    return rows


def _flatten(nested):
    """Return the expressions in nested lists and dicts, one after the other."""
    if isinstance(nested, list | dict):
        parts = nested.values() if isinstance(nested, dict) else nested
        return [x for part in parts for x in _flatten(part)]
    return [nested]


def _refill(nested, values):
    """Return tuples and dicts of this nesting, with values for the expressions."""
    if isinstance(nested, dict):
        return {key: next(values) for key in nested}
    return tuple(_refill(x, values) for x in nested) if isinstance(nested, list) else next(values)


def matrix_product(rows, k):
    """Return the product of a matrix, in rows of `Motion`, and a vector, a tuple."""
    return tuple(dot(tuple(row.values()), tuple(k[j] for j in row)) for row in rows)
