"""Which test files are near a file of the sources, by imports and by names."""

import ast
import re
from collections import Counter, deque
from pathlib import PurePath

PACKAGE = "src/ratestate/__init__.py"


def nearest_first(root):
    """File in src -> the test files that import it, directly or not, the nearest first.

    A word in common, such as `cycles` of fitting/cycles/fit.py and test_fit_cycles.py, counts as
    much as an import less; of equally near ones, that first which speaks more of the file's words.
    """
    files = [*(root / "src").rglob("*.py"), *(root / "tests").rglob("*.py")]
    texts = {str(path.relative_to(root)): path.read_text() for path in files}
    trees = {path: ast.parse(text) for path, text in texts.items()}
    homes = {name: home for home, name in imports(PACKAGE, trees[PACKAGE])}
    trees[PACKAGE] = ast.parse("")  # loads what is used, when it is
    near = {path: set() for path in trees}
    for path, tree in trees.items():
        for module, name in imports(path, tree):
            if module == "ratestate":
                module = homes.get(name, f"ratestate.{name}")
            for wanted in (module, f"{module}.{name}"):
                stem = wanted.replace(".", "/")
                folders = ("src", "tests/helpers", PurePath(path).parent)
                candidates = {f"{folder}/{stem}{end}" for folder in folders
                              for end in (".py", "/__init__.py")}  # fmt: skip
                near[path] |= candidates & trees.keys()
    distances = {path: {} for path in trees}
    for test in (path for path in trees if PurePath(path).name.startswith("test_")):
        seen, waiting = {test: 0}, deque([test])
        while waiting:
            file = waiting.popleft()
            for other in near[file] - seen.keys():
                seen[other] = seen[file] + 1
                waiting.append(other)
        for path, distance in seen.items():
            distances[path][test] = distance - len(words(test) & words(path))
    spoken = {path: Counter(beginnings(text)) for path, text in texts.items()}

    def order(path):
        about = words(path)

        def key(test):
            mentions = sum(spoken[test][word] for word in about) / spoken[test].total()
            return distances[path][test], -mentions, test

        return key

    return {path: sorted(tests, key=order(path)) for path, tests in distances.items()}


def imports(path, tree):
    """(module, name) of all that a file imports, and of what it reads off the package itself."""
    inside = PurePath(path).parts[1:-1]  # the package, for relative imports
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            base = inside[: len(inside) - node.level + 1] if node.level else ()
            module = ".".join([*base, *filter(None, [node.module])])
            yield from ((module, alias.name) for alias in node.names)
        elif isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.Attribute) and ast.unparse(node.value) in ("rs", "ratestate"):
            yield "ratestate", node.attr


def words(path):
    """What a file is about: the beginnings of the words of its path."""
    return {*beginnings(path.removesuffix(".py"))} - {"src", "rate", "test", "init"}


def beginnings(text):
    """The first four letters of each word."""
    return [word[:4] for word in re.split(r"\W|_", text) if word]
