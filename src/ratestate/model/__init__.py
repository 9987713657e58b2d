"""What is simulated, and the quantities and units of it.

=================================== ===========================================================
``slider``                          `SpringSlider`: which parameters a slider may have
``loading``                         `Loading`: what the load point does
``initial_state``                   the state at t = 0, and which values for it agree
``quantities``, ``quantities.toml`` unit, range and name of each quantity; values as text
``units``                           reads values and says what is wrong with one
``arrays``                          axes of a sweep, whether several agree, columns of a record
``batch``                           from named values to a flat batch of cases, and back
``sentences``                       messages kept in TOML files, filled in
=================================== ===========================================================
"""
