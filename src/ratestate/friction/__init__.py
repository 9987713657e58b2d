"""Friction laws and the stability of steady sliding, and what is known of both in closed form.

==================== ============================================================================
``law``              what a friction law is
``law_properties``   what follows from it: numbers of its arguments, steady sliding
``laws``             the built-in laws, a file each
``forms``            forms of friction beside that of eq. 1, a file each
``kinematics``       how fast a slider slips, by the engine's variables
``reversing``        the same where slip may reverse
``functions``        what these are written with, of which the engine has its own versions
``composition``      a law with what else stands in the balance of forces, as one law
``damping``          a dashpot beside friction
``two_states``       what laws of two states have in common
``user_law``         a law of a user's file or class, named with a hash of its source
``law_check``        whether its derivatives and steady sliding are right
``law_arrays``       its methods for arrays, where they are written for numbers
``rate_and_state``   friction, state and steady states in SI (eqs 1 to 3)
``steady_state``     steady sliding by root finding, under a law that does not know it
``linear_stability`` whether steady sliding is stable, by any law
``linear_response``  what small oscillations do to steady sliding, by any law
``critical_speeds``  the speeds at which that changes
``polynomials``      products and roots of polynomials in arrays
``stability``        the same in closed form, by laws of one length (eqs 5 to 7, 10)
``eigenvalues``      the three modes of steady sliding with one state
``hopf_of_law``      whether the Hopf bifurcation is super- or subcritical, by any law
``normal_form``      the same in closed form, by laws of one length
``quasi_static``     excursions and runaway for M = 0, in closed form
``convex``           the function in which these are written
``separatrix``       the edge of runaway for M = 0 where state evolves with slip alone
``elementwise``      functions of arrays that take floats and DataArrays too
``roots``            roots of functions of arrays that increase, most of them nearly linear
==================== ============================================================================
"""
