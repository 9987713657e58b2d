"""Compiled code only: no xarray, no units, no files but those of compiled kernels.

===================================== ==============================================================
``model``, ``statuses.toml``          the system, dimensionless; codes and statuses of cases
``dispatch``, ``backend``             kernels run from Python: threads, time limits, progress
``cuda``, ``cuda_kernels``            the same on a GPU
``jit``, ``compilation``, ``cache``   how kernels are compiled, and when; where they are kept
``pipeline``, ``tracing``             numba's compiler, for what compiled code alone calls; none,
                                      for straight lines of arithmetic
``vectorisation``                     whether their loops over lanes are SIMD code
``law_methods``                       laws as types inside compiled code
``march``, ``saving``                 a run from start to end: segments, saved times, events
``return_map``                        from one point of the section V = V_lp to the next
``lanes``, ``return_lanes``, ``rows`` loops over sliders side by side; the layout of their buffer
``lane_case``                         which case a lane takes, its first step, when to give up
``equations``                         the equations at one point: speed, force, power
``rodas5p``, ``tableau``, ``tangent`` a step, its coefficients, its derivative
``taylor``                            a step of the Taylor method where nothing is stiff
``recurrences``, ``series``           the equations as a graph, from a law's own formulas,
``expansion``                         and its coefficients
``taylor_lanes``                      loops of such steps
``return_taylor_lanes``               and of those of a return map
``lane_sets``                         sliders that change their method
``drift``                             what a step takes from equations that change in time
``reversing``                         the derivative where slip may reverse
``tuples``                            arithmetic on states of any number of variables
``step_control``                      whether a step is accepted, and how large the next one is
``dense_output``                      polynomials within a step
``extremes``                          where in it forces and speeds are extreme, and speeds cross
``events``, ``return_events``         what happens within a step: extremes, returns, runaway
``waveform``                          Fourier integrals of the stress over a return
``periodicity``                       which period a run has, or that it has none
``im2017``                            the paper's own scheme
``rigid``, ``rigid_steps``            the state where the slider moves with its load point (K = inf)
``exp``                               an exponential for all lanes at once
``functions``                         others, with which forms of friction are written
``noise``                             noise of a record made white
===================================== ==============================================================
"""
