"""Names in backticks: linked where they are documented, code where they exist, else a warning.

Docstrings name internal functions and their own parameters, too.  Those have no page, but they
must be there: a name that is neither is told, and nitpicky builds fail.
"""

import functools
import importlib
import inspect
import re
from pathlib import Path

from sphinx import addnodes


def resolve(app, env, node, contnode):
    """A public name under the package, or a literal for one that exists; None if it does not."""
    if node.get("refdomain") != "py":
        return None
    target = node["reftarget"].removesuffix("()")
    domain = env.domains.python_domain
    for name in (target, f"ratestate.{target}"):
        found = domain.objects.get(name)
        if found:
            return domain.resolve_xref(
                env, node["refdoc"], app.builder, "obj", name, _relative(node), contnode
            )
    return contnode if target in _known(node) or _exists(target, node) else None


def _relative(node):
    """The node without its context, so that its whole name is looked up."""
    node = node.copy()
    node["py:module"] = node["py:class"] = None
    return node


def _exists(target, node):
    """Whether the name can be imported as it stands, from the package, or from its own module."""
    whole = [target, f"ratestate.{target}"]
    if module := node.get("py:module"):
        whole += [f"{module}.{target}", f"{module}.{node.get('py:class')}.{target}"]
    owner = _owner(node)
    if owner is not None:
        whole += [f"{getattr(owner, '__module__', None)}.{target}"]
    return any(map(_importable, whole))


@functools.cache
def _importable(name):
    parts = name.split(".")
    for k in range(len(parts), 0, -1):
        try:
            found = importlib.import_module(".".join(parts[:k]))
        except (ImportError, ValueError):
            continue
        try:
            functools.reduce(getattr, parts[k:], found)
        except AttributeError:
            continue
        return True
    return False


def _owner(node):
    """The object whose docstring holds the node."""
    while node is not None and not isinstance(node, addnodes.desc):
        node = node.parent
    signature = node[0] if node is not None else {}
    if not signature.get("module"):
        return None
    module = importlib.import_module(signature["module"])
    try:
        return functools.reduce(getattr, signature["fullname"].split("."), module)
    except AttributeError:
        return None


def _known(node):
    """Parameters of the object whose docstring holds the node."""
    owner = _owner(node)
    return inspect.signature(owner).parameters if callable(owner) else ()


def reset_matplotlib(gallery_conf, fname):
    """The house's style before each script of the gallery."""
    import matplotlib

    matplotlib.rcdefaults()
    matplotlib.rc_file(Path(__file__).parent.parent / "matplotlibrc")
    matplotlib.use("agg")


def escape_bars(app, what, name, obj, options, lines):
    """|x| is an absolute value, not a substitution; what is code stays as it is."""
    lines[:] = [re.sub(r"(``.*?``)|\|", lambda m: m[1] or r"\|", line) for line in lines]


def setup(app):
    app.connect("missing-reference", resolve)
    app.connect("autodoc-process-docstring", escape_bars)
    return {"parallel_read_safe": True}
