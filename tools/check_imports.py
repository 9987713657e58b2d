"""Check imports: no circles, no names that are missing, and no private names in the explorer.

Imports inside functions and those for types alone count too, which the contracts of import-linter
leave aside.  Scripts in benchmarks, docs and tools, which no test runs, import what is there.  The
explorer uses only names of `ratestate` that docs/reference/api.md documents:
``python tools/check_imports.py``.
"""

import ast
import graphlib
import importlib
import re
import sys
from pathlib import Path

import grimp

ROOT = Path(__file__).parents[1]
SCRIPTS = ("benchmarks", "docs", "tools")
EXPLORER, REFERENCE = ROOT / "src/ratestate_explorer", ROOT / "docs/reference/api.md"


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


def private(module, documented):
    """Names of `ratestate` that a module uses, and that are not documented."""
    text = module.read_text("utf-8")
    used = [name.replace("rs.", "ratestate.", 1) for name in re.findall(r"\brs(?:\.\w+)+", text)]
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "ratestate":
            used += [f"{node.module}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Import):
            used += [alias.name for alias in node.names if alias.name.startswith("ratestate.")]
    for name in used:  # a class is documented with its methods
        if not any(f"{name}.".startswith(f"{known}.") for known in documented):
            yield f"{module.relative_to(ROOT)}: {name}"


def documented_names():
    """Return the names in the tables of the reference, without the packages that have them."""
    names = re.findall(r"^\| .*?`rs\.([\w.]+)", REFERENCE.read_text("utf-8"), re.MULTILINE)
    packages = {name.partition(".")[0] for name in names if "." in name}
    return {f"ratestate.{name}" for name in names if name not in packages}


def main():
    graph = grimp.build_graph("ratestate", "ratestate_explorer", cache_dir=None)
    if found := circle(graph):
        sys.exit(f"error: a circle of imports: {' -> '.join(found)}")
    scripts = [script for folder in SCRIPTS for script in (ROOT / folder).rglob("*.py")]
    if lost := [name for script in scripts for name in absent(script)]:
        sys.exit(f"error: scripts import what is not there: {', '.join(lost)}")
    known = documented_names()
    if found := [name for file in EXPLORER.glob("*.py") for name in private(file, known)]:
        sys.exit(f"error: the explorer uses what is not documented: {', '.join(found)}")
    print(f"{len(graph.modules)} modules, {graph.count_imports()} imports, no circle")


if __name__ == "__main__":
    main()
