"""How numba compiles what compiled code alone calls: without what only Python would need.

Such a function is inlined, or at least linked, into the kernel that calls it, and so gets no
machine code of its own.  numba's passes for closures, exceptions, array expressions and listings
are left out, of which the engine has none; laws, which users write, go through all.
"""

from typing import Any

import numba
from numba.core import typed_passes as typed
from numba.core import untyped_passes as untyped
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
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
        return [_lowered(PASSES)]


class LawCompiler(CompilerBase):
    """The compiler of the methods of laws."""

    def define_pipelines(self):
        """The only one."""
        untyped_passes = DefaultPassBuilder.define_untyped_pipeline(self.state).passes
        typed_passes = DefaultPassBuilder.define_typed_pipeline(self.state).passes
        passes = [one for one, _ in (*untyped_passes, *typed_passes)]
        return [_lowered([*passes, typed.NoPythonSupportedFeatureValidation, typed.IRLegalization])]


def _lowered(passes):
    """numba's `PassManager` of these passes and of what makes code of their result."""
    manager = PassManager("ratestate")
    for one in [*passes, LinkedLowering, typed.NoPythonBackend]:
        manager.add_pass(one, one._name)
    manager.finalize()
    return manager
