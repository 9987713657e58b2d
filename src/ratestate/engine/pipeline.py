"""How numba compiles what compiled code alone calls: without what only Python would need.

Such a function is inlined, or at least linked, into the kernel that calls it, and so gets no
machine code of its own.  numba's passes for closures, literals, exceptions with arguments, array
expressions and listings are left out, of which the engine has none.  What laws hold, which users
write, may need them, and Python objects (of a `print`, say): that is compiled by numba alone.
"""

from typing import Any

import numba
from numba.core import typed_passes as typed
from numba.core import untyped_passes as untyped
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase
from numba.core.compiler_machinery import PassManager, register_pass

#: numba's own, in their order, that the engine needs before it is lowered
PASSES: list[Any] = [
    untyped.TranslateByteCode,
    untyped.FixupArgs,
    untyped.IRProcessing,
    untyped.RewriteSemanticConstants,
    untyped.DeadBranchPrune,
    untyped.GenericRewrites,
    untyped.ReconstructSSA,
    untyped.DeadBranchPrune,
    typed.NopythonTypeInference,
    typed.PreLowerStripPhis,
    typed.IRLegalization,
]


# what numba itself makes of code that Python can call; compiled, so that no type is declared
make_function: Any = numba._dynfunc.make_function  # type: ignore[attr-defined]


class LinkedLibrary(JITCodeLibrary):
    """Code for others to be linked with, never run itself."""

    def _finalize_final_module(self):
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True


@register_pass(mutates_CFG=True, analysis_only=False)
class LinkedLowering(typed.NativeLowering):
    """numba's lowering, into a `LinkedLibrary`."""

    _name = "linked_lowering"

    def run_pass(self, state):
        """Lower the function of numba's `state`."""
        state.library = LinkedLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        state.flags.no_compile = True
        super().run_pass(state)
        result, library = state["cr"], (state.library,)
        module, name = result.fndesc.lookup_module(), state.func_id.func_name
        # what numba knows it by, in place of what Python would call
        function = make_function(module, name, "", 0, result.env, library)
        state.targetctx.insert_user_function(function, result.fndesc, library)
        state["cr"] = result._replace(cfunc=function)
        return True


class InnerCompiler(CompilerBase):
    """The compiler of the engine's functions that compiled code alone calls."""

    def define_pipelines(self):
        """The only one."""
        manager = PassManager("ratestate")
        for one in [*PASSES, LinkedLowering, typed.NoPythonBackend]:
            manager.add_pass(one, one._name)
        manager.finalize()
        return [manager]
