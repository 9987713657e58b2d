"""What stands in the engine's equations beside the spring's force, unless there is more.

    eta0 dw/dT = x - S,     dpsi_k/dT = f_k

With normal stress sigma(t), s = sigma(t)/sigma(0), and damping,

    S = N + zeta w,     N = s R + (s - 1) mu_ref/a,     R = (mu - mu_ref)/a,

where N, the strength, is friction R as long as s is 1.  `damping` and `normal_stress` have the
rest.  Arguments and slopes are those of `kinematics`.
"""

from typing import Any


class ConstantNormalStress:
    """The stress S is friction, and the states evolve as the law says."""

    # of `kinematics`
    resistance_in_v: Any
    resistance_slopes: Any
    state_rates: Any
    state_rate_slopes: Any

    def strength_in_v(self, v, w, psi, p):
        """N: friction R, unless normal stress varies."""
        return self.resistance_in_v(v, w, psi, p)

    def strength_slopes(self, v, w, psi, e, p):
        """Slopes of `strength_in_v`."""
        return self.resistance_slopes(v, w, psi, e, p)

    def strength_drift(self, v, w, psi, p):
        """d/dT of `strength_in_v` at constant v and psi, in a tuple; () where that is 0."""
        return ()

    def stress_in_v(self, v, w, psi, p):
        """S: the strength N, unless there is damping."""
        return self.strength_in_v(v, w, psi, p)

    def stress_slopes(self, v, w, psi, e, p):
        """Slopes of `stress_in_v`."""
        return self.strength_slopes(v, w, psi, e, p)

    def rates_in_v(self, v, w, psi, e, p):
        """d psi/dT: `state_rates`, unless normal stress varies."""
        return self.state_rates(v, w, psi, e, p)

    def rate_slopes(self, v, w, psi, e, p):
        """Slopes of `rates_in_v`, as of `state_rates`."""
        return self.state_rate_slopes(v, w, psi, e, p)

    def rate_drift(self, v, w, psi, p):
        """d/dT of `rates_in_v` at constant v and psi, a tuple; () where that is 0."""
        return ()

    def later(self, p, dT):
        """p at a time dT later: others where normal stress varies."""
        return p

    def stiffness(self, kappa, p):
        """K Dc/(a sigma(t)), of which kappa is that at t = 0: so stiff is the spring beside N/s."""
        return kappa

    def history(self, p):
        """What of p changes with time, a tuple: of the last ones."""
        return ()

    # Of varying normal stress alone

    def jumps(self, v, w, psi, p):
        """d psi_k/d ln s of each state, a tuple."""
        raise NotImplementedError

    def after_jump(self, v, w, psi, e, p, rise):
        """psi where ln s has risen at once, at constant V, from which v then follows."""
        raise NotImplementedError

    def at_time(self, p, base, rate, phase):
        """p where normal stress, but for its sinusoid, and its rate are these."""
        raise NotImplementedError
