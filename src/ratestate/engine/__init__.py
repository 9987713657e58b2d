"""The solver: machine code of a law's units, and the control that calls them.

The engine handles numbers and arrays only: no xarray, no units of measurement.

===================================== ==============================================================
``model``, ``statuses.toml``          the dimensionless equations; status codes of cases
``dispatch``, ``backend``             run cases from Python: threads, interruption, progress
``cuda``, ``cuda_driver``             run cases on a GPU; call NVIDIA's driver by ctypes
``control``                           fill lanes with cases; move sliders between methods
``march``                             a run from start to end: segments, jumps, saved times
``return_map``                        from one point of the section V = V_lp to the next
``events``                            extremes, crossings, runaway in a step; the period of a run
``rows``                              layout of the lane buffer; calls of units from the control
``units``                             list of all code that depends on the law
``lanes``, ``taylor_lanes``           try a step in a lane by either method, flag events, commit
``tangent``, ``waveform``             steps with perturbations; Fourier integrals of the stress
``rigid``                             steps of a slider that moves with its load point (K = inf)
``rodas5p``                           a step of Rodas5P
``taylor``                            a Taylor step: its equations, series and length
``code``                              numbers that write LLVM text; units as LLVM text
``compiler``                          compile the control from a small part of Python
``machine_code``                      compile LLVM text, cache it on disk, load it
``programs``                          run compiled programs from Python
``noise``                             whiten the noise of a record
===================================== ==============================================================
"""
