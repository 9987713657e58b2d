"""Add a form of friction, damping and varying normal stress to a friction law.

Each composed law has its own machine code, without the terms that a slider lacks.

Normal stress may vary with time: s(t) = sigma(t)/sigma(0), known from the loading.  The friction
force is sigma(t) mu.  A change of normal stress also changes the states, by
`FrictionLaw.jumps_with_normal_stress`: d psi_k = h_k d ln s, with h_k = h_k0 + h_k1 R.  If sigma
jumps, V does not change, and psi changes as in a very short ramp at constant V.  A slider without
mass then moves at once to the speed at which friction balances the spring: the limit of ever
smaller mass.  (In a short ramp without mass V follows the balance during the ramp.  The states
depend on this if h_k1 is not 0, as under Nagata's law.)

Source of the state's response: Linker & Dieterich (1992) doi:10.1029/92JB00017.
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

#: symbol -> `Parameter` of optional parameters that sliders have under any law; 0 by default
EXTRAS = MappingProxyType({"damping": Parameter("Pa s/m", "damping", ">= 0", "'5 MPa s/m'")})
#: separates the name of a law from the names of its added parts
PART_MARK = "+"
DAMPED = "damping"
VARYING = "varying-sigma"
#: indices of a history, from the end of p: the base, a straight line, and its rate; amplitude,
#: frequency and phase [periods] of a sinusoid on it; and s.  ds/dT and d2s/dT2 follow.
BASE, RATE, AMPLITUDE, FREQUENCY, PHASE, S = range(-8, -2)


class Damped(FrictionLaw):
    """A friction law with damping: S = N + zeta w.

    zeta = damping V_ref/(a sigma).  The damping belongs to the machine, or stands for the waves
    that a fault radiates.

    Source: Rice (1993) doi:10.1029/93JB00191: shear waves give damping = G/(2 c_s).
    """

    OWN_PARAMETERS = EXTRAS


class Varying(FrictionLaw):
    """A friction law under normal stress sigma(t), for the engine alone.

    Its coefficients: the law's own, mu_ref/a, h_k0 and h_k1 of each state, the history of sigma.
    """

    OWN_PARAMETERS: Mapping[str, Parameter] = MappingProxyType({})
    S, PHASE = S, PHASE
    slider_parameters = ("mu0", "V0", "alpha", "sigma_amplitude", "sigma_period")
    varies = True
    inner: FrictionLaw  # the law under a constant sigma

    def coefficients(self, V_ref, slider):
        """Return the law's coefficients at constant sigma, its jumps, sigma's history."""
        of_law = self.inner.coefficients(V_ref, slider)
        mu_ref = self.inner.reference_friction(V_ref, vars(slider))
        jumps = self.inner.jumps_with_normal_stress
        at_mu_ref, by_R = jumps(mu_ref, slider.alpha, slider), jumps(slider.a, 0.0, slider)
        amplitude = slider.sigma_amplitude / slider.sigma
        frequency = slider.Dc / (slider.sigma_period * V_ref)
        history = 1.0, 0.0, amplitude, frequency, 0.0, 1.0, 0.0, 0.0
        return (*of_law, mu_ref / slider.a, *at_mu_ref, *by_R, *history)

    def history(self, p):
        """Return the part of p that describes the history of sigma."""
        return p[BASE:]

    def later(self, p, dT):
        """Return p a time dT later, within the same segment."""
        return self.at_time(p, p[BASE] + dT * p[RATE], p[RATE], p[PHASE] + dT * p[FREQUENCY])

    def at_time(self, p, base, rate, phase):
        """Return p with this base of normal stress, its rate, and the sinusoid's phase."""
        amplitude, frequency = p[AMPLITUDE], p[FREQUENCY]
        speed = 2.0 * math.pi * frequency
        wave = amplitude * sine(phase)
        ds, dds = rate + speed * amplitude * cosine(phase), -speed * speed * wave
        return (*p[:BASE], base, rate, amplitude, frequency, phase, base + wave, ds, dds)

    def stiffness(self, kappa, p):
        return kappa / p[S]


def composed_law(name):
    """Return a law, perhaps composed ("slip+damping"); ParameterError if unknown."""
    law, *parts = name.split(PART_MARK) if isinstance(name, str) else (name,)
    form = parts[0] if parts and parts[0] in FORMS else None
    return composed(friction_law(law), form, DAMPED in parts)


def form_of(law, friction_form=None):
    """Return a form's name in small letters, by default that which the law needs.

    ParameterError if the form is unknown.
    """
    return law.form if friction_form is None else form_name(friction_form)


def composed(law, form=None, damped=False):
    """Return a law of `laws.LAWS` with a form of friction and perhaps damping.

    ParameterError if the law does not take this form.  None selects the law's own form.
    """
    form = law.form if form is None else form
    if form != law.form and (law.form != LOG or not takes_forms(law)):
        needs = (
            f"needs friction_form = {law.form!r}"
            if law.form != LOG
            else "has a friction of its own"
        )
        raise ParameterError(
            f"does not go with law = {law.name!r}, which {needs}",
            "Leave friction_form out, or choose another law.",
            symbol="friction_form",
            value=repr(form),
        )
    if form != LOG:
        law = _add_part(law, form)
    return _add_part(law, DAMPED) if damped else law


def under_varying_stress(law):
    """Return a law, composed or not, as the engine needs it if sigma varies."""
    return _add_part(law, VARYING)


def takes_forms(law):
    """Return whether a law of `laws.LAWS` has eq. 1, in the states themselves."""
    return not law.overrides("friction") and not law.overrides("log_theta")


def forms_of(law):
    """Return the names of the forms that a law takes, its own first, a list."""
    return [law.form, *(FORMS if law.form == LOG and takes_forms(law) else ())]


@functools.cache
def _add_part(law, part):
    """Return the law with another name and one more part of the force balance."""
    kind = type(law)
    added: Any = {DAMPED: Damped, VARYING: Varying}.get(part) or FORMS[part]
    attributes = {"__module__": kind.__module__, "__doc__": kind.__doc__, "__reduce__": _rebuild}
    new = type(f"{added.__name__}{kind.__name__}", (added, kind), attributes)()
    new.name, new.label = f"{law.name}{PART_MARK}{part}", law.label
    new.parameters = {**law.parameters, **added.OWN_PARAMETERS}
    new.inner, new.part = law, part
    return new


def _rebuild(law):
    """Tell pickle how to rebuild a composed law, whose class is in no module."""
    return _add_part, (law.inner, law.part)
