"""Friction that stays finite at rest, and acts against the slip in either direction."""

from types import MappingProxyType

from ..functions import asinh, exp, log
from ..kinematics import Reversing
from ..law import FrictionLaw, eq_1
from ..tuples import dot

NAME = "regularized"
#: symbol -> what it is, of its parameters: none
OWN: MappingProxyType = MappingProxyType({})


class Regularized(Reversing, FrictionLaw):
    """mu = a asinh(V/(2 V0) exp((mu0 + b ln(V0 theta/Dc))/a)), and of a second state likewise.

    It is eq. 1 where that is well above a.  mu_ref is 0, so that friction and stress keep their
    digits where they are small.

    Source: Rice & Ben-Zion (1996) doi:10.1073/pnas.93.9.3811; Lapusta, Rice, Ben-Zion & Zheng
    (2000) doi:10.1029/2000JB900250.
    """

    own = OWN
    # what is known of a law of one length is under eq. 1
    one_length, series = False, None

    def mu(self, V, theta, ages, p, effects):
        """From the theta_k/D_k and the b_k."""
        states = eq_1(p.V0, ages, p, effects)
        return p.a * asinh(0.5 * V / p.V0 * exp(states / p.a))

    def reference(self, mu):
        """0."""
        return 0.0 * mu

    def constants(self, p, effects):
        """Theta at theta_k = D_k/V_ref."""
        at_V_ref = [1.0 / p.V_ref] * len(effects)
        states = eq_1(p.V0, at_V_ref, p, effects)
        return {"barrier": states / p.a - log(p.V0 / p.V_ref)}

    def barrier(self, psi, p):
        """Theta."""
        return self.constant("barrier", p) + dot(self.evolution_effects(p), psi)


FORM = Regularized
