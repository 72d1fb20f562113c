"""LLVM through llvmlite: compiles a module's text to an object, and calls an object's entries."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache
from typing import Any

import llvmlite.binding as llvm

from jacobian.native.direct import NAMES as CALLED


def _target(effort: int = 2) -> Any:
    """A new target machine for each engine, because an engine owns it and frees it."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    target = llvm.Target.from_triple(llvm.get_process_triple())
    return target.create_target_machine(
        cpu=llvm.get_host_cpu_name(), features=features(), opt=effort, reloc="default", codemodel="jitdefault", jit=True
    )


@cache
def features() -> str:
    """The processor's features as a comma-separated list: +avx2 if AVX2 is present, -avx2 if not."""
    return str(llvm.get_host_cpu_features().flatten())


@cache
def name() -> str:
    """The key under which machine code is stored here: LLVM's version, the processor and its features."""
    version = ".".join(map(str, llvm.llvm_version_info))
    return f"{version} {llvm.get_process_triple()} {llvm.get_host_cpu_name()} {features()}"


def object_of(text: str, as_written: bool = False) -> bytes:
    """The optimized module as an object file. ``as_written`` skips the optimization, from which long straight-line
    code gains little.
    """
    machine = _target(1 if as_written else 2)
    module = llvm.parse_assembly(text)
    module.verify()
    module.data_layout = str(machine.target_data)
    if as_written:
        return bytes(machine.emit_object(module))
    options = llvm.create_pipeline_tuning_options(speed_level=2)
    # SLP vectorisation, unlike loop vectorisation, slows straight-line scalar code down
    options.loop_vectorization, options.slp_vectorization = True, False
    builder = llvm.create_pass_builder(machine, options)
    builder.getModulePassManager().run(module, builder)
    return bytes(machine.emit_object(module))


class Entry:
    """A function in machine code that ``engine`` keeps in memory, called without Python's lock."""

    def __init__(self, engine: Any, name: str) -> None:
        self._engine = engine
        self.address: int = engine.get_function_address(name)
        self.call: Callable[[int], None] = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(self.address)


def loaded(data: bytes, names: tuple[str, ...]) -> dict[str, Entry]:
    for each in CALLED:
        llvm.add_symbol(each, ctypes.cast(getattr(ctypes.pythonapi, each), ctypes.c_void_p).value)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _target())
    engine.add_object_file(llvm.ObjectFileRef.from_data(data))
    engine.finalize_object()
    return {name: Entry(engine, name) for name in names}
