"""
A small atlas
=============

What any spring-slider with this b/a does, over its stiffness and its speed. Coarse here;
``ratestate atlas`` draws it in full.
"""

import matplotlib.pyplot as plt

from ratestate import plot
from ratestate.dynamics.atlas import atlas

chart = atlas(2.0, "slip", n=60, rtol=1e-4)
fig, ax = plt.subplots(figsize=(7.2, 4.4))
entries = plot.atlas(chart, ax)
ax.legend(handles=entries, loc="center left", bbox_to_anchor=(1.02, 0.5))
plt.show()
