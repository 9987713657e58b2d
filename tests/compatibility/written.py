"""The calls that made the files in written/, before results recorded their scenario.

The files must be read and verified.  The same calls must give the same numbers.
"""

import ratestate as rs

SLIDER = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, M=3e3, K=9e8, mu0=0.6, V0=1e-9)
STEPS = rs.Loading.steps(1e-4, (0.1, 3.2e-3)).hold(0.3, 0.1)
V_LP = rs.logspace("V_lp", 3.3e-3, 1e-2, 3)
AXES = {"M": rs.logspace("M", 1e3, 1e4, 4)}
RUN = {"t_end": 0.6, "times": [0.0, 0.1, 0.25, 0.35, 0.6], "method": "rodas5p"}
#: name -> the call that makes the result again
RESULTS = {
    "simulate": lambda: rs.simulate(SLIDER, STEPS, **RUN),
    "calls": lambda: rs.simulate(SLIDER, STEPS, **RUN),
    "runs": lambda: rs.simulate(
        SLIDER.replace(M=rs.logspace("M", 1e3, 1e4, 3)),
        rs.Loading.steps(1e-4, (0.1, V_LP)),
        0.3,
        times=[0.0, 0.3],
        initial={"theta": 1.0},
    ),
    "limit_cycle": lambda: rs.limit_cycle(SLIDER, V_LP),
    "stability": lambda: rs.stability(SLIDER, V_LP),
    "continue_cycle": lambda: rs.continue_cycle(SLIDER, "V_lp", 3.4e-3, 3.3e-3),
}


def swept(store):
    """The sweep of the store, begun or resumed."""
    slider = SLIDER.replace(**AXES)
    return rs.sweep(rs.limit_cycle, slider, V_lp=V_LP, store=store, chunk=6)
