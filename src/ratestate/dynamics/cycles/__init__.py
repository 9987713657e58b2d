"""Limit cycles: which one is reached, to full accuracy, and what it is like.

Whether it closes after 1, 2, 4 or more returns `search_step` finds, and `attractor` confirms.

====================================== ==========================================================
``limit_cycle``                        `limit_cycle`: the error beyond which an answer is refused
``orbit``                              `orbit`, one period as a curve: its tolerance
``regimes``                            `classify`: thresholds between the regimes
``attractor``                          from where the search starts; when an orbit counts as steady
                                       sliding, and when it is given up
``search_step``                        how far to leap, when to trust Newton's method, tolerances
                                       of returns, when to look for twice the period
``system``                             sliders in dimensionless form, the section V = V_lp, and the
                                       tightest tolerance
``shooting``, ``iterates``             the return map, its most steps, and Floquet multipliers;
                                       several returns as one
``small_cycles``, ``harmonic_balance`` cycles too small for returns: up to which size and error
``measure``, ``sensitivity``           measures of a cycle, their errors, how often to refine
``variables``                          the same in SI, and what stands for steady sliding
====================================== ==========================================================
"""
