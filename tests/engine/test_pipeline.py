"""The compiler of what compiled code alone calls."""

import numba
import pytest
from user_laws import PLAIN

import ratestate as rs
from ratestate.engine import law_methods  # noqa: F401  (compiled code calls methods of laws)
from ratestate.engine.jit import inlined, inner, lanewise
from ratestate.engine.pipeline import LinkedLibrary
from ratestate.friction.laws import LAWS


def halved(x):
    return 0.5 * x


@pytest.mark.parametrize("decorated", [inlined, inner, lanewise])
def test_inner_functions_are_linked_and_have_no_machine_code(decorated):
    function = decorated(halved)

    @numba.njit
    def twice(x):
        return function(x) + function(2.0 * x)

    assert twice(3.0) == 4.5
    (compiled,) = function.overloads.values()
    assert type(compiled.library) is LinkedLibrary
    assert compiled.library._finalized
    assert "halved" in compiled.library.get_llvm_str()
    assert not numba.core.registry.cpu_target.target_context.codegen()._engine.is_symbol_defined(
        compiled.fndesc.mangled_name
    )


METHODS = {
    "closure": "sum_of = lambda x, y: x + y\n        return (-w * sum_of(v, psi[0]),)",
    "comprehension": "z = [v + x for x in psi]\n        return (-w * z[0],)",
    "loop": "z = v\n        for x in psi:\n            z += x\n        return (-w * z,)",
    "branch": "if v == 9.0:\n            return (0.0,)\n        return (-w * (v + psi[0]),)",
    "function": "def z(x):\n            return v + x\n        return (-w * z(psi[0]),)",
    "exception": "if w < 0: raise ValueError('w', w)\n        return (-w * (v + psi[0]),)",
    "print": "print('w', w)\n        return (-w * (v + psi[0]),)",
}


@pytest.mark.parametrize("source", METHODS.values(), ids=METHODS)
def test_methods_of_laws_may_hold_what_numba_knows(law_file, source):
    law = LAWS[rs.register(law_file(PLAIN.replace("return (-w * (v + psi[0]),)", source, 1)))]

    @inner
    def between(law, v, w, psi, e, p):
        return law.rates(v, w, psi, e, p)

    @numba.njit
    def rates(law, v, w, psi, e, p):
        return between(law, v, w, psi, e, p)

    assert rates(law, 0.5, 2.0, (1.0,), (), (1.2,)) == (-3.0,)
