"""The state-evolution laws (eqs 2 and 3): a class each, and an instance of it in `LAWS`.

Each law is written once, in the log variables of the engine, which compiles this same source,

    w = V/V0,   v = ln w,   psi = ln(V0 theta/Dc),   e = exp(-psi),

as ``d psi/d(t V0/Dc)``.  They know no velocity but V0, so V0 may be chosen freely: the textbook
form ``d theta/dt`` (rate_and_state.py) is the same function with V0 := Dc/theta (then psi = 0 and
w = V theta/Dc).

A law is a class, of which the engine compiles the methods: a kernel is compiled for the law that it
is given, and for no other.

Adding a law: a class with these methods here, and its instance in `LAWS`.

Sources: Dieterich (1979) doi:10.1029/JB084iB05p02161 (aging), Ruina (1983)
doi:10.1029/JB088iB12p10359 (slip), Gu, Rice, Ruina & Tse (1984) doi:10.1016/0022-5096(84)90007-3
(runaway); equation numbers are those of Im, Marone & Elsworth (2019).
"""

import math

from ..errors import ParameterError


class EvolutionLaw:
    """What all laws have in common: names, and methods that know numbers alone."""

    name: str
    synonyms: tuple[str, ...]  # other names by which it is known, in small letters


class SlipLaw(EvolutionLaw):
    """Slip (Ruina) law, eq. 3."""

    name = "slip"
    synonyms = ("ruina",)

    def rate(self, w, v, psi, e):
        """The rate d psi/dT = -w (v + psi)."""
        return -w * (v + psi)

    def rate_partials(self, w, v, psi, e):
        """Derivatives of `rate` with respect to v and psi."""
        return -w * (v + psi) - w, -w

    def rate_partials_2(self, w, v, psi, e):
        """Second derivatives of `rate`: vv, v psi, psi psi."""
        return -w * (v + psi) - 2.0 * w, -w, 0.0

    def rate_partials_3(self, w, v, psi, e):
        """Third derivatives of `rate`: vvv, vv psi, v psi psi, psi psi psi."""
        return -w * (v + psi) - 3.0 * w, -w, 0.0, 0.0

    def heals_at_rest(self):
        """Whether state evolves without slip, so that `rate` depends on e; here it does not."""
        return False

    def runs_away(self, y, kappa, c):
        """Whether a slider without mass runs away for sure: Q = y - kappa/c >= 0, c = beta - 1 > 0.

        y = v + psi; with slip D instead of time dQ/dD = c Q + kappa w_lp/w, so that Q, once
        positive, grows for ever, whatever the load point does.  Where w >> w_lp it does not
        otherwise.  Numbers, not arrays; False where c <= 0.
        """
        return c > 0.0 and c * y >= kappa

    def held(self, psi, v, w, h):
        """psi after a time h at the constant speed w = exp(v), and its derivative by v."""
        decay = math.exp(-w * h)
        return (psi + v) * decay - v, decay * (1.0 - (psi + v) * w * h) - 1.0

    def relaxed(self, psi, v, v_end, slip, forced):
        """psi at the end of a slip [Dc] from the speed v to v_end, given the integral of `forcing`.

        The law is linear in s = v + psi: ds/dD = -s + dv/dD.
        """
        return (psi + v) * math.exp(-slip) + forced - v_end

    def forcing(self, curvature, part, w_end):
        """What drives s with slip: dv/dD, where (V/V_end)^2 is `part`, of slope -`curvature`."""
        return 0.5 * curvature / part


class AgingLaw(EvolutionLaw):
    """Aging (Dieterich) law, eq. 2; methods as those of `SlipLaw`."""

    name = "aging"
    synonyms = ("ageing", "dieterich", "slowness")

    def rate(self, w, v, psi, e):
        """The rate d psi/dT = exp(-psi) - w."""
        return e - w

    def rate_partials(self, w, v, psi, e):
        """Derivatives of `rate` with respect to v and psi."""
        return -w, -e

    def rate_partials_2(self, w, v, psi, e):
        """Second derivatives of `rate`: vv, v psi, psi psi."""
        return -w, 0.0, e

    def rate_partials_3(self, w, v, psi, e):
        """Third derivatives of `rate`: vvv, vv psi, v psi psi, psi psi psi."""
        return -w, 0.0, 0.0, -e

    def heals_at_rest(self):
        """Whether state evolves without slip, so that `rate` depends on e; here it does."""
        return True

    def runs_away(self, y, kappa, c):
        """Whether a slider without mass runs away for sure: exp(-y) <= 1 - kappa/c, kappa < c.

        dy/dD = c (1 - exp(-y)) - kappa + kappa w_lp/w then stays positive.  Where w >> w_lp it does
        not otherwise.  Numbers, not arrays; False where c <= kappa.
        """
        return c > kappa and y >= -math.log1p(-kappa / c)

    def held(self, psi, v, w, h):
        """psi after a time h at the constant speed w = exp(v), and its derivative by v."""
        decay = math.exp(-w * h)
        theta = math.exp(psi)
        grown = -math.expm1(-w * h) / w
        new = theta * decay + grown
        return math.log(new), (w * h * decay * (1.0 / w - theta) - grown) / new

    def relaxed(self, psi, v, v_end, slip, forced):
        """psi at the end of a slip [Dc] from the speed v to v_end, given the integral of `forcing`.

        The law is linear in theta V0/Dc = exp(psi): d exp(psi)/dD = -exp(psi) + 1/w.
        """
        return math.log(math.exp(psi) * math.exp(-slip) + forced)

    def forcing(self, curvature, part, w_end):
        """What drives exp(psi) with slip, 1/w, where (V/V_end)^2 is `part`."""
        return 1.0 / w_end / math.sqrt(part)


SLIP, AGING = SlipLaw(), AgingLaw()
#: name of an evolution law -> the law
LAWS = {law.name: law for law in (SLIP, AGING)}
#: name or synonym -> name of the law
LAW_OF = {known: law.name for law in LAWS.values() for known in (law.name, *law.synonyms)}


def evolution_law(law):
    """The law of `LAWS` with this name or synonym; ParameterError for an unknown one."""
    return LAWS[law_name(law)]


def known_law(law):
    """A law's name in `LAWS`, from that name or a synonym, in any capitals.

    None for an unknown one, or what is no string.
    """
    return LAW_OF.get(law.lower()) if isinstance(law, str) else None


def law_name(law):
    """A law's name as by `known_law`; ParameterError for an unknown one, or what is no string."""
    if name := known_law(law):
        return name
    names, others = " or ".join(map(repr, LAWS)), ", ".join(sorted(LAW_OF.keys() - LAWS.keys()))
    raise ParameterError(f"law = {law!r} is unknown; choose {names} (or {others})")
