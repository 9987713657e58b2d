"""Ends with an error where files of the package import each other in a circle.

Imports inside functions and those for types alone count too, which the contracts of import-linter
leave aside: ``python tools/check_imports.py``.
"""

import graphlib
import sys

import grimp


def main():
    graph = grimp.build_graph("ratestate", cache_dir=None)
    needs = {module: graph.find_modules_directly_imported_by(module) for module in graph.modules}
    try:
        graphlib.TopologicalSorter(needs).prepare()
    except graphlib.CycleError as error:
        circle = " -> ".join(reversed(error.args[1]))
        sys.exit(f"error: a circle of imports: {circle}")
    print(f"{len(needs)} modules, {graph.count_imports()} imports, no circle")


if __name__ == "__main__":
    main()
