"""Friction and the stability of steady sliding: closed forms, and runaway without inertia.

================== =====================================================================
``laws``           which evolution laws there are: their rates in log variables
``rate_and_state`` friction, state and steady states in SI (eqs 1 to 3)
``stability``      K_c, V_c, eta, f_n: whether steady sliding is stable (eqs 5 to 7, 10)
``eigenvalues``    the three modes of steady sliding
``normal_form``    whether the Hopf bifurcation is super- or subcritical
``quasi_static``   excursions and runaway for M = 0, in closed form
``separatrix``     the edge of runaway for M = 0 under the slip law
``elementwise``    functions of arrays that take floats and DataArrays too
================== =====================================================================
"""
