"""What a slider does: motions, limit cycles, branches and basins, and how results record it.

The package ``simulation`` has `simulate`; ``cycles`` has `limit_cycle`, `orbit` and `classify`;
``continuation`` has `continue_cycle` and `folds`.
"""
