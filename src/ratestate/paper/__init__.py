"""The figures of Im, Marone & Elsworth (2019), doi:10.1016/j.jmps.2018.08.026, and its claims.

============================= ===========================================================
``parameters``                the paper's values, each once
``figures``, ``figures.toml`` which figures there are; how they become files
``fig1``                      friction after a velocity step, by both laws
``fig2``                      steps below and above V_c
``fig3``                      the map of stability over M and V_lp
``fig4``                      amplitude of limit cycles over V_lp, and eta
``fig5``                      the same over frequency, and f_n
``fig6``                      slow stick-slip at a stiffness near K_c
``atlas``                     beyond the paper: the regimes, with its sliders on them
``branches``                  all limit cycles of Fig. 2's slider for three springs
``basins``                    which disturbances stable sliding survives
``scheme_run``                a run by the paper's own scheme: `im2017`
``scheme``, ``scheme_map``    the error of this scheme with its time step; its V_c
``claims.toml``               what the paper says, and the last digit it gives
``claim``                     which values a printed number covers; whether ours agree
``claims_steps``              measures those on Figs 1 to 3
``claims_cycles``             measures those on Figs 4 and 5
``claims_regimes``            measures those on Figs 4b, 4c and 6, and section 5
``claims_table``              puts them in order, and writes that down
============================= ===========================================================

Each figure's module has `compute`, its numbers, and `draw`; so have all beyond the paper but
`atlas`, whose numbers `make` computes.
"""


def __getattr__(name):
    if name != "im2017":
        raise AttributeError(f"module 'ratestate.paper' has no attribute {name!r}")
    from .scheme_run import im2017

    return im2017
