"""
Regimes over stiffness and speed
================================

The map shows how a spring-slider with b/a = 2 moves under the slip law. Stiffness and speed are
dimensionless, so it holds for any such slider. This map is coarse; ``ratestate atlas`` draws it in
full.
"""

import matplotlib.pyplot as plt

import ratestate as rs
from ratestate import plot

chart = rs.atlas(2.0, "slip", n=60, rtol=1e-4)
fig, ax = plt.subplots(figsize=(7.2, 4.4))
entries = plot.atlas(chart, ax)
ax.legend(handles=entries, loc="center left", bbox_to_anchor=(1.02, 0.5))
plt.show()
