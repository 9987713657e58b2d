"""The equations of motion under a law as expressions, in the engine's variables.

    dx/dT = kappa (w_lp - w),    dv/dT = g/(eta0 c) - sum_k s_k f_k,    d psi_k/dT = f_k

with g = x - S, and with w, c and s_k from `point`: if slip never reverses, c is w and the s_k
are 0.  With damping, and s = sigma(t)/sigma(0) if normal stress varies,

    S = N + zeta w,     N = s R + (s - 1) mu_ref/a,     R = (mu - mu_ref)/a.

Derivatives are along directions (x, omega, psi), with d omega = dw/c: derivatives by omega are at
constant psi, and derivatives by psi at constant w.
"""

from typing import Any

from .expressions import MAKING
from .rewriting import Derivative, values_of
from .tuples import dot

#: symbols of numbers other than the state and its functions
NUMBERS = "x", "w_lp", "g", "F", "q", "moves"
CONSTANTS = "kappa", "1/eta0", "m", "dT"
#: coefficients before s and its derivatives, if normal stress varies (`composition.Varying`)
HISTORY = "base", "rate", "amplitude", "frequency", "phase"


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
        self.law, self.own, self.reverses = law, law.equations, reverses
        self._lists: dict[str, Any] = {}
        self.graph = self.own.graph
        self.v, self.w, self.psi = self.own.v, self.own.w, self.own.psi
        self.symbols = {name: self._symbol(name) for name in NUMBERS}
        self.symbols |= {name: self._symbol(name, is_constant=True) for name in CONSTANTS}
        self.symbols["z"] = [self._symbol(("z", k)) for k in range(2 + len(self.psi))]
        if reverses:
            self.v, self.w, self.c = map(self._symbol, ("v", "w", "c"))
            self.t, self.slope = map(self._symbol, ("t", "slope"))  # w/c, and d ln |w|/d omega
        self.R = self.v if reverses else self.own.resistance[0]
        self.N, self.f, self.p, self.drifts = self.R, self.own.rates, (*self.own.constants,), {}
        if law.varies:
            self._vary()
        self.S = self.N if self.own.zeta is None else self.N + self.own.zeta * self.w
        self._lists |= {"S": self.S, "N": self.N, "R": self.R, "f": self.f}
        self._lists["exponents"] = self.own.exponents
        self._rest = iter((self._slopes, self._changes, self._without_inertia))

    def _symbol(self, name, is_constant=False):
        return self.graph.symbol(("motion", name), is_constant=is_constant)

    def _vary(self):
        """Add varying normal stress, whose numbers follow the law's own coefficients."""
        n = len(self.psi)
        level, *h = (self._symbol(("p", k), is_constant=True) for k in range(1 + 2 * n))
        s, ds, dds = (self._symbol(name) for name in ("s", "ds", "dds"))
        self.p = (*self.p, level, *h, *map(self._symbol, HISTORY), s, ds, dds)
        self.N = s * self.R + (s - 1.0) * level
        self.by_R, self.drifts, growth = h[n:], {s: ds, ds: dds}, ds / s
        jumps = [one + self.R * by_R for one, by_R in zip(h[:n], self.by_R, strict=True)]
        self.f = [f + growth * jump for f, jump in zip(self.f, jumps, strict=True)]
        self._lists["jumps"] = jumps

    def _along(self, x, omega, *psi, has_rates=True, dT=0.0):
        """Return a `Derivative` in a direction and a time dT, of F too if has_rates."""
        known, effects, moves = self.symbols, self.own.effects, self.symbols["moves"]
        changes = {known["x"]: x, **dict(zip(self.psi, psi, strict=True))}
        change_of_w, growth = moves * omega, omega
        if self.reverses:
            c, t, sigma, of_log = self.c, self.t, dot(effects, psi), self.slope * omega
            bend, of_v = (1.0 - t) * (1.0 + t), omega + t * sigma
            growth = t * omega - bend * sigma  # of ln c
            changes |= {self.v: of_v, t: bend * of_v, self.own.v: of_log}
            changes |= {c: moves * growth * c, self.w: change_of_w * c}
            changes[self.slope] = self.slope * (moves * growth - of_log)
        else:
            changes |= {self.v: omega, self.w: change_of_w * self.w}
        changes[known["q"]] = -moves * growth * known["q"]
        changes |= {one: dT * rate for one, rate in self.drifts.items()}
        along = Derivative(self.graph, changes)
        along.found[known["g"]] = x - along(self.S)
        if self.reverses and has_rates:
            along.found[known["F"]] = dot(effects, tuple(map(along, self.f)))
        return along

    def __getitem__(self, name):
        """Return a list.  A fixed order of making them fixes the order of terms in sums."""
        with MAKING:
            while name not in self._lists:
                if (make := next(self._rest, None)) is None:
                    raise KeyError(name)
                self._lists |= make()
        return self._lists[name]

    def _slopes(self):
        n, zero = 2 + len(self.psi), self.graph.number(0.0)
        units = [[self.graph.one if j == k else zero for j in range(n)] for k in range(n)]
        self._units, self._basis = units, [self._along(*one) for one in units]
        _, by_omega, *by_psi = self._basis
        own = [along(f) for along, f in zip(by_psi, self.f, strict=True)]
        S, R = ([along(one) for along in self._basis[1:]] for one in (self.S, self.R))
        found = {"S_slopes": S, "R_slopes": R, "f_slopes": [[*map(by_omega, self.f)], own]}
        return found | ({"jump_growth": dot(R[1:], self.by_R)} if self.drifts else {})

    def _changes(self):
        known, f, (x, v, *psi) = self.symbols, self.f, self.symbols["z"]
        held = [self._along(*one, has_rates=False) for one in self._units[1:]]
        forces = self._along(x, v, *psi, dT=known["dT"])
        in_time = Derivative(self.graph, self.drifts)
        of_v, omega = known["q"] * known["g"], v
        if self.reverses:
            of_v = of_v + known["m"] * self.t * known["F"]
            omega = v - self.t * dot(self.own.effects, psi)
        along_z = self._along(x, omega, *psi)
        equations = [-known["kappa"] * self.w, of_v, *f]
        return {
            "changes": [*map(forces, (self.S, self.N, self.R))],
            "N_drift": [in_time(self.N)] if self.drifts else [],
            "f_drift": [*map(in_time, f)] if self.drifts else [],
            "inertia_slopes": [-along(of_v) for along in held],
            "jacobian": _rows(equations, self._basis),
            "curvature": _rows(map(along_z, equations), self._basis),
            "change_of_trace": along_z(sum(self["f_slopes"][1], held[0](of_v))),
        }

    def _without_inertia(self):
        by_omega, *by_psi = self["S_slopes"]
        slaved = -dot(by_psi, self.f) / by_omega
        return {"slaved": slaved, "slaved_slopes": [along(slaved) for along in self._basis[2:]]}

    def values(self, name, known):
        """Return the values of one of the lists, in tuples; rows as dicts.

        inputs : symbol -> value; w and exponentials too if they are known
        """
        return _put(self[name], iter(values_of(_numbers_of(self[name]), known)))


def _rows(equations, basis):
    """Return the derivatives of each equation, column -> element, without zeros."""
    rows = []
    for one in equations:
        row = {j: along(one) for j, along in enumerate(basis)}
        rows.append({j: x for j, x in row.items() if x is not x.graph.number(0.0)})
    return rows


def _numbers_of(found):
    """Return the expressions in nested lists and dicts, one after the other."""
    if isinstance(found, list | dict):
        parts = found.values() if isinstance(found, dict) else found
        return [x for one in parts for x in _numbers_of(one)]
    return [found]


def _put(found, values):
    """Return the same nesting, tuples for lists, with values for expressions."""
    if isinstance(found, dict):
        return {key: next(values) for key in found}
    return tuple(_put(one, values) for one in found) if isinstance(found, list) else next(values)


def matrix_product(rows, k):
    """Return the product of a matrix, in rows of `Motion`, and a vector, a tuple."""
    return tuple(dot(tuple(row.values()), tuple(k[j] for j in row)) for row in rows)
