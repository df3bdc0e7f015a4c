"""Machine code in this process, by LLVM.

The graph is simplified already: LLVM's own passes were measured to change the run time by less than 2 % and to add a
third to the compile time, so the code generator works on the text as it stands.
"""

import itertools
import threading
from functools import cache

from llvmlite import binding

_OPTIMISATION = 2  # of the code generator; 1 and 3 were measured to be neither quicker to compile nor to run
_lock = threading.Lock()
_serials = itertools.count()


class Compiled:
    """A function in memory; its code lives as long as this object."""

    def __init__(self, ir: str, function: str) -> None:
        with _lock:
            library = binding.JITLibraryBuilder().add_ir(ir).add_current_process().export_symbol(function)
            self._code = library.link(_compiler(), f"cutpoint{next(_serials)}")
        self.address: int = self._code[function]


@cache
def _compiler() -> binding.LLJIT:
    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    machine = binding.Target.from_default_triple().create_target_machine(
        cpu=binding.get_host_cpu_name(),
        features=binding.get_host_cpu_features().flatten(),
        opt=_OPTIMISATION,
        reloc="pic",
        codemodel="default",
        jit=True,
    )
    return binding.create_lljit_compiler(machine)


@cache
def vector_width() -> int:
    """How many float64 numbers one instruction of this processor takes."""
    features = binding.get_host_cpu_features()
    return 8 if features.get("avx512f") else 4 if features.get("avx2") else 2
