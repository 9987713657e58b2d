"""A friction law with what else stands in the balance of forces, as one law.

Code is written for each composed law.  It leaves out what a slider lacks: the code for eq. 1
without damping is that of the law of state alone.

Normal stress may vary with time: s(t) = sigma(t)/sigma(0), known from the loading.  Friction pushes
with sigma(t) mu.  A change of normal stress changes the states too, by
`FrictionLaw.jumps_with_normal_stress`: d psi_k = h_k d ln s, with h_k = h_k0 + h_k1 R.  Where sigma
jumps, V stays as it is, and psi does what it does in a very short ramp at that V.  A slider without
mass then is at once at the speed at which friction balances the spring: what one of ever smaller
mass does.  (In a short ramp V follows the balance meanwhile, which the states feel where h_k1 is
not 0, under the law of Nagata.)

Source of the latter: Linker & Dieterich (1992) doi:10.1029/92JB00017.
"""

import functools
import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from ..errors import ParameterError
from .forms import FORMS, form_name
from .functions import cosine, sine
from .law import FrictionLaw
from .law_formula import LOG, Parameter
from .laws import friction_law

#: symbol -> what it is, of parameters that every slider has, and needs only where it is not 0
EXTRAS = MappingProxyType({"damping": Parameter("Pa s/m", "damping", ">= 0", "'5 MPa s/m'")})
#: between the name of a law and of what it is composed with
JOINT = "+"
DAMPED = "damping"
VARYING = "varying-sigma"
#: places, from the end of p, of a history: base, its rate, amplitude, frequency and phase [periods]
#: of a sinusoid on it, and s; then ds/dT and d2s/dT2, to which the base, a straight line, adds
#: nothing
BASE, RATE, AMPLITUDE, FREQUENCY, PHASE, S = range(-8, -2)


class Damped(FrictionLaw):
    """A friction law with damping: S = N + zeta w, with zeta = damping V_ref/(a sigma).

    The dashpot is of the machine, or it stands for the waves that a fault radiates.

    Source: Rice (1993) doi:10.1029/93JB00191, with damping G/(2 c_s), that of shear waves.
    """

    OWN = EXTRAS


class Varying(FrictionLaw):
    """A friction law under normal stress sigma(t), which the engine alone is given.

    After the law's own coefficients come mu_ref/a, h_k0 and h_k1 of each state, and the history.
    """

    OWN: Mapping[str, Parameter] = MappingProxyType({})
    S, PHASE = S, PHASE
    of_slider = ("mu0", "V0", "alpha", "sigma_amplitude", "sigma_period")
    varies = True
    inner: FrictionLaw  # the law under a constant sigma

    def coefficients(self, V_ref, slider):
        """Those of the law under a constant sigma, those of its own, and sigma's history."""
        of_law = self.inner.coefficients(V_ref, slider)
        mu_ref = self.inner.reference_friction(V_ref, vars(slider))
        jumps = self.inner.jumps_with_normal_stress
        at_mu_ref, by_R = jumps(mu_ref, slider.alpha, slider), jumps(slider.a, 0.0, slider)
        amplitude = slider.sigma_amplitude / slider.sigma
        frequency = slider.Dc / (slider.sigma_period * V_ref)
        history = 1.0, 0.0, amplitude, frequency, 0.0, 1.0, 0.0, 0.0
        return (*of_law, mu_ref / slider.a, *at_mu_ref, *by_R, *history)

    def history(self, p):
        """Those of p that belong to the history."""
        return p[BASE:]

    def later(self, p, dT):
        """p at a time dT later in the same segment."""
        return self.at_time(p, p[BASE] + dT * p[RATE], p[RATE], p[PHASE] + dT * p[FREQUENCY])

    def at_time(self, p, base, rate, phase):
        """p where the base of normal stress, its rate, and the sinusoid's phase are these."""
        amplitude, frequency = p[AMPLITUDE], p[FREQUENCY]
        speed = 2.0 * math.pi * frequency
        wave = amplitude * sine(phase)
        ds, dds = rate + speed * amplitude * cosine(phase), -speed * speed * wave
        return (*p[:BASE], base, rate, amplitude, frequency, phase, base + wave, ds, dds)

    def stiffness(self, kappa, p):
        """K Dc/(a sigma(t))."""
        return kappa / p[S]


def composed_law(name):
    """The law of this name, or of a name as `composed` gives it, such as "slip+damping".

    ParameterError for an unknown one.
    """
    own, *parts = name.split(JOINT) if isinstance(name, str) else (name,)
    form = parts[0] if parts and parts[0] in FORMS else None
    return composed(friction_law(own), form, DAMPED in parts)


def form_of(law, friction=None):
    """The name of this form of friction, in any capitals; by default that which the law is for.

    ParameterError for an unknown one.
    """
    return law.form if friction is None else form_name(friction)


def composed(law, form=None, damped=False):
    """A law of `laws.LAWS` with a form of friction, by name, and damping; the law if with none.

    ParameterError for a form that the law does not take.  None is that which the law is for.
    """
    form = law.form if form is None else form
    if form != law.form:
        if law.form != LOG:
            raise ParameterError(
                f"friction = {form!r} does not go with law = {law.name!r}, which is for friction = "
                f"{law.form!r}; leave friction out, or choose another law"
            )
        if not takes_forms(law):
            raise ParameterError(
                f"friction = {form!r} does not go with law = {law.name!r}, which has a friction of "
                f"its own; leave friction out, or choose another law"
            )
    if form != LOG:
        law = _with(law, form)
    return _with(law, DAMPED) if damped else law


def under_varying_stress(law):
    """The law, with all that it is made of, as the engine needs it where sigma varies."""
    return _with(law, VARYING)


def takes_forms(law):
    """Whether friction under a law of `laws.LAWS` is that of eq. 1 in the states themselves."""
    return not law.gives("friction") and not law.gives("log_theta")


def forms_of(law):
    """Names of the forms of friction that a law of `laws.LAWS` takes, its own first, a list."""
    return [law.form, *(FORMS if law.form == LOG and takes_forms(law) else ())]


@functools.cache
def _with(law, part):
    """A law of another name, to which a part of the force balance is added; else as the law."""
    kind = type(law)
    changes: Any = {DAMPED: Damped, VARYING: Varying}.get(part) or FORMS[part]
    own = {"__module__": kind.__module__, "__doc__": kind.__doc__, "__reduce__": _made_again}
    made = type(f"{changes.__name__}{kind.__name__}", (changes, kind), own)()
    made.name, made.label = f"{law.name}{JOINT}{part}", law.label
    made.parameters = {**law.parameters, **changes.OWN}
    made.inner, made.part = law, part
    return made


def _made_again(law):
    """For pickle: its class is found nowhere."""
    return _with, (law.inner, law.part)
