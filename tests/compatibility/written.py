"""Files as ratestate writes them: ``python tests/compatibility/written.py FOLDER``.

Those in written/ were made before the package was given its present layout.  They must be read and
verified, and run again to the same numbers.
"""

import shutil
import sys
from pathlib import Path

import ratestate as rs
from ratestate import files

SLIDER = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, M=3e3, K=9e8, mu0=0.6, V0=1e-9)
STEPS = rs.Loading.steps(1e-4, (0.1, 3.2e-3)).hold(0.3, 0.1)
V_LP = rs.logspace("V_lp", 3.3e-3, 1e-2, 3)
#: name -> what makes the result again
RESULTS = {
    "simulate": lambda: rs.simulate(
        SLIDER, STEPS, 0.6, times=[0.0, 0.1, 0.25, 0.35, 0.6], method="rodas5p"
    ),
    "limit_cycle": lambda: rs.limit_cycle(SLIDER, V_LP),
    "stability": lambda: rs.stability(SLIDER, V_LP),
    "continue_cycle": lambda: rs.continue_cycle(SLIDER, "V_lp", 3.4e-3, 3.3e-3),
}
AXES = {"M": rs.logspace("M", 1e3, 1e4, 4)}


def swept(store):
    """The sweep of the store, begun or resumed."""
    slider = SLIDER.replace(**AXES)
    return rs.sweep(rs.limit_cycle, slider, V_lp=V_LP, store=store, chunk=6)


def write(folder):
    for name, make in RESULTS.items():
        files.write(make(), folder / f"{name}.nc")
    swept(folder / "store.zarr")
    shutil.make_archive(folder / "store", "zip", folder / "store.zarr")
    shutil.rmtree(folder / "store.zarr")


if __name__ == "__main__":
    write(Path(sys.argv[1]))
