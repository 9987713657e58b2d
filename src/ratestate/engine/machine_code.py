"""LLVM text made into machine code, as an object that can be kept, and loaded."""

import functools

import llvmlite.binding as llvm

#: objects that are loaded: their code stays as long as these are referred to
_LOADED: list = []


@functools.cache
def _initialized():
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.Target.from_triple(llvm.get_process_triple())


def target(cpu=None, features=None):
    """The machine for which code is made: this one, or one of this kind of processor."""
    native = llvm.get_host_cpu_features().flatten() if features is None else features
    return _initialized().create_target_machine(
        cpu=cpu or llvm.get_host_cpu_name(),
        features=native,
        opt=3,
        reloc="pic",
        codemodel="small",
    )


def compiled(text, machine=None):
    """The object, bytes, of LLVM text, which is taken as it is: its optimiser brings nothing."""
    machine = machine or target()
    module = llvm.parse_assembly(text)
    module.triple, module.data_layout = llvm.get_process_triple(), str(machine.target_data)
    module.verify()
    return machine.emit_object(module)


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
