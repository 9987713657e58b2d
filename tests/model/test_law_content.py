"""What a user's law takes its numbers from is part of its name, however it gets there."""

import sys
import types

import pytest
from user_laws import PLAIN

import ratestate as rs
from ratestate.friction.law_content import content_of
from ratestate.friction.user_law import is_unchanged

#: what a law refers to -> an import, the factor of its rates, and two modules with a value
MADE_OF = {
    "a module in a package": ("import maker.sub", "maker.sub.G", "", "G = {}"),
    "a function in a cache": (
        "import maker",
        "maker.G()",
        "import functools\n@functools.cache\ndef G():\n    return {}",
        "",
    ),
    "an object": (
        "from maker import TABLE",
        "TABLE.G",
        "from collections import namedtuple\n"
        "TABLE = namedtuple('Table', 'G H' if {} > 1.0 else 'H G')(1.0, 2.0)",
        "",
    ),
    "another function for a name": (
        "from maker import one, two, which",
        "(one() * two() * which())",
        "def one():\n    return 1.0\ndef two():\n    return 2.0\nwhich = (one, two)[int({}) - 1]",
        "",
    ),
    "a decorator": (
        "import math\nfrom maker import G",
        "G(0.0)",
        "import functools, math\n@functools.wraps(math.exp)\ndef G(x):\n    return {} + x",
        "",
    ),
}


@pytest.mark.parametrize("kind", MADE_OF)
def test_what_a_law_refers_to_by_detours_counts(kind, monkeypatch):
    first, G, maker, inner = MADE_OF[kind]

    def name(value):
        module, sub, home = (types.ModuleType(one) for one in ("maker", "maker.sub", "home"))
        for one, text in ((module, maker), (sub, inner)):
            exec(text.format(value), vars(one))
            monkeypatch.setitem(sys.modules, one.__name__, one)
        module.sub = sub
        text = PLAIN.replace("import ratestate as rs", f"import ratestate as rs\n{first}")
        monkeypatch.setitem(sys.modules, "home", home)
        exec(text.replace("(-w *", f"(-{G} * w *").replace("- w,", f"- {G} * w,"), vars(home))
        return content_of(home.Plain)

    assert name(1.0) == name(1.0)
    assert name(1.0) != name(2.0)


def test_attributes_of_one_name_with_a_global_do_not_count():
    def content(G):
        home = {"__name__": "home", "G": G}
        exec("class Law:\n    def rates(self, v, w, psi, e, p):\n        return p.G\n", home)
        return content_of(home["Law"])

    assert content(1.0) == content(2.0) == content(sys.stdout)


@pytest.mark.parametrize("part", [{}, {"damping": 1e4}, {"friction": "regularized"}])
def test_kernels_of_a_law_that_has_changed_since_it_was_registered_are_not_kept(part, monkeypatch):
    """They would be kept under the name of the law as it was."""
    home = types.ModuleType("home")
    home.__file__ = "home.py"
    monkeypatch.setitem(sys.modules, "home", home)
    exec("G = 1.0" + PLAIN.replace("(-w *", "(-G * w *").replace("- w,", "- G * w,"), vars(home))
    common = {"a": 0.003, "b": 0.006, "Dc": 1e-5, "sigma": 2e6, "M": 3e3, "K": 9e8}
    law = rs.SpringSlider(**common, law=home.Plain, **part).friction_law
    assert is_unchanged(law)
    home.G = 2.0
    assert not is_unchanged(law)
    assert is_unchanged(rs.SpringSlider(**common, law="aging", **part).friction_law)
