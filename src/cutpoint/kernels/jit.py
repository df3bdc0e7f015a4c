"""Machine code in this process, by LLVM.

The graph is simplified already: LLVM's own passes were measured to change the run time by less than 2 % and to add a
third to the compile time, so the code generator works on the text as it stands.
"""

import itertools
import threading
from collections.abc import Mapping
from functools import cache

from llvmlite import binding

OPTIMISATION = 2  # of the code generator; 1 and 3 were measured to be neither quicker to compile nor to run
_lock = threading.Lock()
_serials = itertools.count()


class Compiled:
    """Functions in memory; their code lives as long as this object.

    Attributes:
        address: of the first function.
        addresses: of all, by name.
    """

    def __init__(
        self, ir: str, *functions: str, symbols: Mapping[str, int] | None = None, optimisation: int = OPTIMISATION
    ) -> None:
        """symbols: addresses of what the text declares.  optimisation: of the code generator, 0 to 3."""
        library = binding.JITLibraryBuilder().add_ir(ir).add_current_process()
        for name in functions:
            library.export_symbol(name)
        for name, address in (symbols or {}).items():
            library.import_symbol(name, address)
        with _lock:
            self._code = library.link(_compiler(optimisation), f"cutpoint{next(_serials)}")
        self.addresses: dict[str, int] = {name: self._code[name] for name in functions}
        self.address = self.addresses[functions[0]]


@cache
def _compiler(optimisation: int) -> binding.LLJIT:
    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    machine = binding.Target.from_default_triple().create_target_machine(
        cpu=binding.get_host_cpu_name(),
        features=binding.get_host_cpu_features().flatten(),
        opt=optimisation,
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
