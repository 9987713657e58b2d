"""Laws as users write them: the texts of law files."""

#: the aging law where m = 1, with an exponent m else, in the first derivatives alone
MINE = """
import ratestate as rs

class Mine(rs.FrictionLaw):
    name = "mine"
    parameters = {"m": rs.Parameter("1", "exponent of the state", "> 0", "1.5")}

    def coefficients(self, V_ref, slider):
        return slider.b / slider.a, slider.m

    def exponents(self, v, w, psi, p):
        return -psi[0], p[1] * (v + psi[0]) - psi[0]

    def rates(self, v, w, psi, e, p):
        return ((e[0] - e[1]) / p[1],)

    def rate_partials(self, v, w, psi, e, p):
        return (-e[1],), ((-e[0] - (p[1] - 1.0) * e[1]) / p[1],)
"""
#: a law in three lines, to which a test adds a mistake
PLAIN = """
import ratestate as rs

class Plain(rs.FrictionLaw):
    name = "plain"

    def rates(self, v, w, psi, e, p):
        return (-w * (v + psi[0]),)

    def rate_partials(self, v, w, psi, e, p):
        return (-w * (v + psi[0]) - w,), (-w,)
"""
#: slip law about another steady state, which has to be found
CUBIC = """
import ratestate as rs

class Cubic(rs.FrictionLaw):
    name = "cubic"
    parameters = {"q": rs.Parameter("1", "offset", "> 0", "0.5")}

    def coefficients(self, V_ref, slider):
        return slider.b / slider.a, slider.q

    def rates(self, v, w, psi, e, p):
        z = v + psi[0]
        return (-w * (z - p[1] + 0.1 * z**3),)

    def rate_partials(self, v, w, psi, e, p):
        z = v + psi[0]
        slope = 1.0 + 0.3 * z * z
        return (-w * (z - p[1] + 0.1 * z**3 + slope),), (-w * slope,)
"""
#: the same law, written for numbers alone
NUMBERS = """
import math
import ratestate as rs

class Numbers(rs.FrictionLaw):
    name = "numbers"
    parameters = {"q": rs.Parameter("1", "offset", "> 0", "0.5")}

    def coefficients(self, V_ref, parameters):
        return parameters.b / parameters.a, math.exp(math.log(parameters.q))

    def rates(self, v, w, psi, e, p):
        z = v + psi[0]
        if z > p[1]:
            return (-w * (z - p[1] + 0.1 * z * z * z),)
        return (w * (p[1] - z - 0.1 * z * z * z),)

    def rate_partials(self, v, w, psi, e, p):
        z = v + psi[0]
        slope = 1.0 + 0.3 * z * z
        return (-w * (z - p[1] + 0.1 * z**3 + slope),), (-w * slope,)
"""
#: slip law whose state evolves the slower, the faster the slider beside its V0
SLOWED = """
import ratestate as rs

class Slowed(rs.FrictionLaw):
    name = "slowed"
    of_slider = ("V0",)

    def coefficients(self, V_ref, slider):
        return slider.b / slider.a, V_ref / slider.V0

    def rescaled(self, p, ratio):
        return p[0], p[1] * ratio

    def rates(self, v, w, psi, e, p):
        return (-w * (v + psi[0]) / (1.0 + p[1] * w),)

    def rate_partials(self, v, w, psi, e, p):
        part = w / (1.0 + p[1] * w)
        return (-part * (1.0 + (v + psi[0]) / (1.0 + p[1] * w)),), (-part,)
"""
