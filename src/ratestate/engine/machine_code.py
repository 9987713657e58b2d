"""LLVM text made into machine code, as an object that can be kept, and loaded."""

import functools

import llvmlite.binding as llvm

#: objects that are loaded: their code stays as long as these are referred to
_LOADED: list = []


@functools.cache
def _initialized(triple):
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    return llvm.Target.from_triple(triple)


def processor():
    """LLVM's names of this machine, its kind of processor, and the features that code may use."""
    features = llvm.get_host_cpu_features().flatten()
    return llvm.get_process_triple(), llvm.get_host_cpu_name(), features


#: LLVM's names of processors that lower their clock where they use their widest vectors
THROTTLED = "skylake", "cannonlake", "cascadelake", "cooperlake"


def doubles_of_vector():
    """How many doubles the vectors have in which this processor is fastest."""
    features, processor = llvm.get_host_cpu_features(), llvm.get_host_cpu_name()
    if features.get("avx512f") and not processor.startswith(THROTTLED):
        return 8
    return 4 if features.get("avx") else 2


def target(cpu=None, features=None, triple=None):
    """The machine for which code is made: this one, or one of this kind of processor."""
    here, own, native = processor()
    return _initialized(triple or here).create_target_machine(
        cpu=cpu or own,
        features=native if features is None else features,
        opt=3,
        reloc="pic",
        codemodel="small",
    )


def optimized(text, machine, level):
    """Return LLVM text as a module for a machine; level : of optimisation."""
    layout = f'target datalayout = "{machine.target_data}"\ntarget triple = "{machine.triple}"\n'
    module = llvm.parse_assembly(layout + text)
    module.verify()
    if level > 0:
        options = llvm.create_pipeline_tuning_options(speed_level=level)
        options.loop_vectorization = options.slp_vectorization = False
        passes = llvm.create_pass_builder(machine, options)
        passes.getModulePassManager().run(module, passes)
    return module


def compiled(text, machine=None, level=0):
    """The object, bytes, of LLVM text.

    level : of optimisation; straight lines of code, which say each thing once, need none
    """
    machine = machine or target()
    return machine.emit_object(optimized(text, machine, level))


def loaded(code, names):
    """Addresses (dict name -> int) of functions in an object; ImportError where one is missing."""
    # (the engine owns the machine that it is given)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), target())
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    found = {name: engine.get_function_address(name) for name in names}
    if missing := [name for name, address in found.items() if address == 0]:
        raise ImportError(f"compiled code lacks {', '.join(missing)}")
    _LOADED.append(engine)
    return found
