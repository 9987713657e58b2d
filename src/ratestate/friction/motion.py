"""The equations of motion under a law as expressions, in the variables that the engine integrates.

    dx/dT = kappa (w_lp - w),    dv/dT = g/(eta0 c) - sum_k s_k f_k,    d psi_k/dT = f_k

with g = x - S, and w, c and s_k of `kinematics`: if slip never reverses, c is w and the s_k are 0.
With s = sigma(t)/sigma(0), if normal stress varies, and damping,

    S = N + zeta w,     N = s R + (s - 1) mu_ref/a,     R = (mu - mu_ref)/a.

Derivatives are along directions (x, omega, psi), with d omega = dw/c: those by omega are at
constant psi, and those by psi at constant w.
"""

from .functions import where
from .rewriting import Derivative, values_of
from .tuples import dot

#: symbols of numbers, beside the state and what follows from it
NUMBERS = "x", "w_lp", "g", "F", "q", "moves", "growth"
CONSTANTS = "kappa", "1/eta0", "m", "dT"


class Motion:
    """The equations of motion, and what follows from them: lists of expressions, by name.

    ============================  ===============================================================
    stress, strength, resistance  S, N and R
    rates                         f of each state
    stress_slopes                 of S by omega, and by each of psi
    resistance_slopes             the same of R
    rate_slopes                   of each rate by omega; of each by its own state
    force_slopes                  how S, N and R change along z, here a direction (x, omega, psi),
                                  and in a time dT
    strength_drift, rate_drift    in T at constant v and psi; none unless normal stress varies
    inertia_slopes                of -(q g + m t F) by omega and by each of psi, where F is held
    jacobian                      rows of derivatives of the equations by x, omega and each of psi:
                                  column -> element, unless that is 0
    curvature                     how `jacobian` changes along z
    change_of_trace               how the trace of the Jacobian matrix in x, v and psi changes
                                  along z
    ============================  ===============================================================

    They hold the symbols

    ========  ===================================================================================
    g, F      x - S, or 0 at rest, and sum_k beta_k f_k: known as numbers
    q, m      factors of the equation of v, q g + m t F: 1/(eta0 c) and 1, unless it is scaled
    moves     1, or 0 at rest, where w is a constant
    growth    of ln s in T
    z         a direction (x, v, psi)
    ========  ===================================================================================
    """

    def __init__(self, law):
        self.law, self.own = law, law.equations
        self.graph = self.own.graph
        self.v, self.w, self.psi = self.own.v, self.own.w, self.own.psi
        self.symbols = {name: self._symbol(name) for name in NUMBERS}
        self.symbols |= {name: self._symbol(name, is_constant=True) for name in CONSTANTS}
        self.z = [self._symbol(("z", k)) for k in range(2 + len(self.psi))]
        places = range(law.n_coefficients)
        changing = law.history(places)
        own = (*self.own.constants,)
        self.p = (*own, *(self._symbol(("p", k), k not in changing) for k in places[len(own) :]))
        if law.reverses:
            self.v, self.w, self.c = map(self._symbol, ("v", "w", "c"))
            self.t, self.slope = map(self._symbol, ("t", "slope"))  # w/c, and d ln |w|/d omega
        growth = self.symbols["growth"]
        self.changes_in_time = law.rates_in_time(growth, self.p)
        self.R = self.v if law.reverses else self.own.resistance[0]
        self.N = law.strength_of(self.R, self.p)
        self.S = law.stress_of(self.N, self.w, self.p)
        f = law.rates_of(tuple(self.own.rates), self.R, growth, self.p)
        self.f = list(map(self.graph.number, f))
        # All at once, and not when they are asked for: sums are in the order in which terms were
        # made.
        self.lists = self._lists()

    def _symbol(self, name, is_constant=False):
        return self.graph.symbol(("motion", name), is_constant=is_constant)

    def _along(self, x, omega, *psi, has_rates=True, dT=0.0):
        """`Derivative` in a direction; without the change of F if not has_rates.

        dT : how much time passes meanwhile
        """
        known, effects, moves = self.symbols, self.own.effects, self.symbols["moves"]
        changes = {known["x"]: x, **dict(zip(self.psi, psi, strict=True))}
        change_of_w, growth = moves * omega, omega
        if self.law.reverses:
            c, t, sigma, of_log = self.c, self.t, dot(effects, psi), self.slope * omega
            bend, of_v = (1.0 - t) * (1.0 + t), omega + t * sigma
            growth = t * omega - bend * sigma  # of ln c
            changes |= {self.v: of_v, t: bend * of_v, self.own.v: of_log}
            changes |= {c: moves * growth * c, self.w: change_of_w * c}
            changes[self.slope] = self.slope * (moves * growth - of_log)
        else:
            changes |= {self.v: omega, self.w: change_of_w * self.w}
        changes[known["q"]] = -moves * growth * known["q"]
        changes |= {one: dT * rate for one, rate in self.changes_in_time.items()}
        along = Derivative(self.graph, changes)
        along.found[known["g"]] = x - along(self.S)
        if self.law.reverses and has_rates:
            along.found[known["F"]] = dot(effects, tuple(map(along, self.f)))
        return along

    def _lists(self):
        known, graph, f, n = self.symbols, self.graph, self.f, 2 + len(self.psi)
        zero, (x, v, *psi) = graph.number(0.0), self.z
        units = [[graph.one if j == k else zero for j in range(n)] for k in range(n)]
        basis = [self._along(*one) for one in units]
        by_omega, *by_psi = basis[1:]
        held = [self._along(*one, has_rates=False) for one in units[1:]]
        forces = self._along(*self.z, dT=known["dT"])
        in_time = Derivative(graph, self.changes_in_time)
        of_v, omega = known["q"] * known["g"], v
        if self.law.reverses:
            of_v = of_v + known["m"] * self.t * known["F"]
            omega = v - self.t * dot(self.own.effects, psi)
        along_z = self._along(x, omega, *psi)
        equations = [-known["kappa"] * self.w, of_v, *f]
        own_slopes = [along(one) for along, one in zip(by_psi, f, strict=True)]
        trace = sum(own_slopes, held[0](of_v))
        varies = self.law.varies
        return {
            "stress": [self.S],
            "strength": [self.N],
            "resistance": [self.R],
            "rates": f,
            "stress_slopes": [along(self.S) for along in basis[1:]],
            "resistance_slopes": [along(self.R) for along in basis[1:]],
            "rate_slopes": [*map(by_omega, f), *own_slopes],
            "force_slopes": [*map(forces, (self.S, self.N, self.R))],
            "strength_drift": [in_time(self.N)] if varies else [],
            "rate_drift": [*map(in_time, f)] if varies else [],
            "inertia_slopes": [-along(of_v) for along in held],
            "jacobian": _rows(equations, basis),
            "curvature": _rows(map(along_z, equations), basis),
            "change_of_trace": [along_z(trace)],
        }

    def known(self, v, w, psi, p, e=None, z=(), **numbers):
        """Symbols, w and exponentials -> values; of those that are given.

        e : as of `kinematics`; None if it is not at hand
        """
        known = {self.v: v, self.w: w, **dict(zip(self.psi, psi, strict=True))}
        known |= dict(zip(self.p, p, strict=False)) | dict(zip(self.z, z, strict=False))
        known |= {self.symbols[name]: x for name, x in numbers.items()}
        if self.law.varies:
            known[self.symbols["growth"]] = self.law.growth(p)
        if e is not None:
            if self.law.reverses:
                (log_size, size), c = self.law.magnitude(v, w), e[0]
                known |= {self.own.v: log_size, self.own.w: size, self.c: c, self.t: w / c}
                known[self.slope] = where(w > 0.0, c, -c) / size
            known |= dict(zip(self.own.exponentials, e[self.law.reverses :], strict=True))
        return known

    def __call__(self, name, v, w, psi, p, e=None, moves=1.0, **others):
        """Values of one of the lists; rows as dicts.

        others : values of those of the symbols that the list needs
        """
        known, found = self.known(v, w, psi, p, e, moves=moves, **others), self.lists[name]
        if not _has_rows(found):
            return tuple(values_of(found, known))
        values = iter(values_of([x for row in found for x in row.values()], known))
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
