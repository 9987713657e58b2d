"""What the likelihood says of each estimate: profiles, posterior, intervals.

===================== ==========================================================
``uncertainty``       which source each interval has, and when a fit starts again
``noise_uncertainty`` what the uncertainty of the noise adds to that of estimates
``transients``        what residuals show after steps: whether the law fits
``quantities``        what is reported, as functions of the coordinates
``profiles``          which quantities need a profile
``profile``           one profile: its points, and whether an end is open
``constrained``       the best fit with one quantity held
``posterior``         the prior, samples, evidence, and whether they are reliable
``posterior.toml``    its sentences
===================== ==========================================================

The likelihood itself is computed in `generalized_least_squares`, where it is largest, and in
`posterior`.
"""
