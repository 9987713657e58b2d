"""Whether a motion leaves the domain of the friction law: pushed by friction, or pulled back."""

import numpy as np

from .results import flags

#: flag of `domain_variables` -> its meaning
OUTSIDE_DOMAIN = {-1: "unknown", 0: "inside", 1: "mu_negative", 2: "spring_reverses", 3: "both"}


def outside_domain(law, mu_min, reversal_margin):
    """Whether the motion leaves the law's domain, int8 of `OUTSIDE_DOMAIN`; -1 where mu_min is NaN.

    Eq. 1 is for forward slip, V > 0, against which friction acts.  It allows mu to fall below 0,
    where friction would have to push; and it does not reverse the slip where the spring pulls the
    slider back harder than friction can hold, tau < -sigma mu.  The computed motion goes on, but no
    real slider moves like that.  Friction that is finite at rest allows both: there slip reverses.
    """
    outside = (mu_min < 0.0) + 2 * (reversal_margin < 0.0)
    outside = np.where(law.reverses, 0, outside)
    return np.where(np.isnan(mu_min), -1, outside).astype(np.int8)


def domain_variables(law, batch, mu_min, reversal_margin):
    """The variables that show whether the motion leaves the law's domain, name -> Variable.

    Under ``mu_min``, ``reversal_margin`` and ``outside_domain``, all in the sweep's dims.

    mu_min, reversal_margin : (n,) smallest mu and tau/sigma + mu; NaN where there is no motion
    """
    code = outside_domain(law, mu_min, reversal_margin)
    values = {"mu_min": mu_min, "reversal_margin": reversal_margin, "outside_domain": code}
    variables = {name: batch.variable(value, name) for name, value in values.items()}
    variables["outside_domain"].attrs |= flags(OUTSIDE_DOMAIN)
    return variables
