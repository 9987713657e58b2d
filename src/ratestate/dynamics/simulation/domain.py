"""Where a motion leaves the domain of the friction law.

Eq. 1 is for forward slip, V > 0, against which friction acts.  It allows mu to fall below 0, where
friction would have to push; and it does not reverse the slip where the spring pulls the slider back
harder than friction can hold, tau < -sigma mu.  The computed motion goes on, but no real slider
moves like that.
"""

import numpy as np

#: flag -> its meaning
FLAGS = {-1: "unknown", 0: "inside", 1: "mu_negative", 2: "spring_reverses", 3: "both"}
#: names of the variables
NAMES = ("mu_min", "reversal_margin", "outside_domain")


def domain_variables(batch, mu_min, reversal_margin):
    """The variables that show whether the motion leaves the domain, name -> Variable.

    mu_min, reversal_margin : (n,) smallest mu and tau/sigma + mu; NaN where there is no motion
    """
    outside = (mu_min < 0.0) + 2 * (reversal_margin < 0.0)
    flags = np.where(np.isnan(mu_min), -1, outside).astype(np.int8)
    values = zip(NAMES, (mu_min, reversal_margin, flags), strict=True)
    variables = {name: batch.variable(value, name) for name, value in values}
    variables["outside_domain"].attrs["flag_values"] = np.array(list(FLAGS), np.int8)
    variables["outside_domain"].attrs["flag_meanings"] = " ".join(FLAGS.values())
    return variables
