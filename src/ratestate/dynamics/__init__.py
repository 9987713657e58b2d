"""What a slider does: motions, limit cycles, branches and basins, and how results record it.

``simulation``                     motion under any loading: `simulate`
``cycles``                         limit cycles: `limit_cycle`, `orbit`, `classify`
``continuation``                   branches of cycles: `continue_cycle`; K_fold
``steady_sliding``                 `stability`: closed forms and eigenvalues
``frequency_response``             `frequency_response`: gain, phase, resonance and its quality
``hopf``                           `hopf` and `bautin`: type of the bifurcation, which is degenerate
                                   where its coefficient is within rounding of 0
``basin``, ``disturbances``        `escape`; sizes of disturbances tried, accuracy of the smallest
``atlas``                          `atlas`: range and density of its axes
``verdict``                        `verdict`: regimes without mass, K up to which a fold is sought
``verdict_sentences``              its text: which sentences hold, when K counts as K_c, and when
                                   inertia is negligible
``domain``                         when a motion is outside the domain of the friction law
``results``                        parts that results have in common; parameters of their slider
``recipe``, ``attributes``         the scenario in a result, written and read; altered attributes
``refusals``                       messages on arguments that cannot be used (``refusals.toml``)
``progress``                       progress bars: after how long one appears
================================== ================================================================
=======
The package ``simulation`` has `simulate`; ``cycles`` has `limit_cycle`, `orbit` and `classify`;
``continuation`` has `continue_cycle` and `folds`.
"""
