"""Ends with an error where modules import each other in a circle, or scripts what is not there.

Imports inside functions and those for types alone count too, which the contracts of import-linter
leave aside; scripts are those of benchmarks, docs and tools, which no test runs:
``python tools/check_imports.py``.
"""

import ast
import graphlib
import importlib
import sys
from pathlib import Path

import grimp

ROOT = Path(__file__).parents[1]
SCRIPTS = ("benchmarks", "docs", "tools")


def circle(graph):
    """The modules of a circle of imports, or None."""
    needs = {module: graph.find_modules_directly_imported_by(module) for module in graph.modules}
    try:
        graphlib.TopologicalSorter(needs).prepare()
    except graphlib.CycleError as error:
        return error.args[1][::-1]


def absent(script):
    """What a script imports from the package, and is not in it."""
    for node in ast.walk(ast.parse(script.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        else:
            continue
        for name in names:
            if name.split(".")[0] == "ratestate" and not exists(name):
                yield f"{script.relative_to(ROOT)}: {name}"


def exists(name):
    """Whether this is a module, or a name in one."""
    parent, _, last = name.rpartition(".")
    try:
        importlib.import_module(name)
    except ModuleNotFoundError:
        return parent in sys.modules and hasattr(sys.modules[parent], last)
    return True


def main():
    graph = grimp.build_graph("ratestate", cache_dir=None)
    if found := circle(graph):
        sys.exit(f"error: a circle of imports: {' -> '.join(found)}")
    scripts = [script for folder in SCRIPTS for script in (ROOT / folder).rglob("*.py")]
    if lost := [name for script in scripts for name in absent(script)]:
        sys.exit(f"error: scripts import what is not there: {', '.join(lost)}")
    print(f"{len(graph.modules)} modules, {graph.count_imports()} imports, no circle")


if __name__ == "__main__":
    main()
