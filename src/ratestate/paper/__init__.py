"""The figures of Im, Marone & Elsworth (2019), doi:10.1016/j.jmps.2018.08.026.

`parameters` holds the paper's values; ``fig1`` to ``fig6`` each compute the numbers of a figure
and draw them, as do `scheme`, `branches` and `basins`; figures.toml lists them, and `figures`
writes their files.
claims.toml has what the paper says, ``claims_steps``, ``claims_cycles`` and ``claims_regimes``
measure it, and `claims_table` compares the two and writes that down.
"""
