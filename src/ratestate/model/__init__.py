"""The slider and its loading, and the quantities and units of both.

=================================== ===========================================================
``slider``                          `SpringSlider`: its parameters, critical stiffness and speeds
``parameters``                      parameters given in other ways: for the whole contact, K/sigma
``loading``                         `Loading`: the calls that make a history, which keeps them
``load_point``                      speed, displacement and normal stress of a loading at any time
``history``                         piecewise linear histories, of speed and of normal stress
``segments``                        histories from the rows of a record, and along a sinusoid
``initial_state``                   the state at t = 0, and which values for it agree
``quantities``, ``quantities.toml`` unit, range and name of each quantity; values as text
``units.toml``                      what values in a unit are called, and how they are shown
``units``                           values read into SI, and messages about those that cannot be
``conversion``                      results in other units, and back to SI
``arrays``                          arrays of a sweep as a flat batch of cases, and back; columns
``user_laws``                       `register`: friction laws of one's own
``names``                           mistyped names, and sentences of messages kept in TOML files
=================================== ===========================================================
"""
