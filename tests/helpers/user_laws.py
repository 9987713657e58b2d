"""Laws as users write them: the texts of law files."""

#: with an exponent m: the aging law where m = 1, that of Perrin, Rice & Zheng where m = 2
MINE = """
import ratestate as rs

class Mine(rs.FrictionLaw):
    name = "mine"
    parameters = {"m": rs.laws.Parameter("1", "exponent of the state", "> 0", "1.5")}

    def evolution(self, V, theta, p):
        return (1 - (V * theta / p.Dc) ** p.m) / p.m
"""
#: the slip law, to which a test adds a mistake
PLAIN = """
import ratestate as rs

class Plain(rs.FrictionLaw):
    name = "plain"

    def evolution(self, V, theta, p):
        return -V * theta / p.Dc * rs.laws.log(V * theta / p.Dc)
"""
#: slip law about another steady state, which has to be found
CUBIC = """
import ratestate as rs

class Cubic(rs.FrictionLaw):
    name = "cubic"
    parameters = {"q": rs.laws.Parameter("1", "offset", "> 0", "0.5")}

    def evolution(self, V, theta, p):
        z = rs.laws.log(V * theta / p.Dc)
        return -V * theta / p.Dc * (z - p.q + 0.1 * z**3)
"""
