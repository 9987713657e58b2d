"""Branches of limit cycles, their bifurcations, and cycles beside stable steady sliding.

================ ===============================================================================
``branch``       `continue_cycle`: arguments that are refused; at which amplitude a branch ends at
                 a Hopf point, after how many points it is given up, which ends raise
``branch_start`` with which cycle it begins, and where none can be used
``family``       the return map of sliders along a parameter: tolerances, scales, longest step
``arclength``    how far a step goes, when it is repeated shorter, and which end is reached
``bifurcations`` what counts as fold, period doubling or torus, and which folds are noise
``newton``       when a point has converged, and what counts as a jump of the map
``polish``       each point to full accuracy, and its error
``coexistence``  K_fold: from which eta on it is sought, and from which K/K_c on it counts
================ ===============================================================================
"""
