"""In-process machine code by LLVM, compiled once and then cached on disk.

The graph is already simplified: LLVM's own passes were measured to change the run time by less than 2 % and to add a
third to the compile time, so the code generator takes the IR unoptimised.
"""

import itertools
import os
import sys
from collections.abc import Callable, Mapping
from functools import cache, lru_cache
from pathlib import Path
from typing import NamedTuple

import llvmlite
from llvmlite import binding

from cutpoint.kernels.machine.cache import Cache, key_of, user_folder
from cutpoint.kernels.machine.forks import new_lock
from cutpoint.kernels.machine.loading_time import LOADED_AT
from cutpoint.kernels.machine.waiting import interruptible
from cutpoint.version import __version__

OPTIMISATION = 2  # of the code generator; 1 and 3 were measured to be faster neither to compile nor to run
_LINKS = 64
"""That one linker serves: it remembers some 9 kB of each, though the code be gone, until it goes itself."""

_RELOCATION, _MODEL = "pic", "default"
_lock, _generator = new_lock(), new_lock()
_serials = itertools.count()

_llvm = getattr(binding.ffi.lib, "_lock", None)  # of llvmlite's own, held during every call
if _llvm is not None and hasattr(os, "register_at_fork"):
    # fork waits until LLVM is idle: a child process could not finish work of other threads in it
    os.register_at_fork(before=_llvm.__enter__, after_in_parent=_llvm.__exit__, after_in_child=_llvm.__exit__)


class Unwritten(NamedTuple):
    """A module's text that need not be written if its code is in the disk cache.

    by: everything that determines the text, apart from the modules that write it.
    """

    by: tuple[object, ...]
    write: Callable[[], str]


class Compiled:
    """Functions loaded in memory; their code lives as long as this object.

    Attributes:
        address: of the first function.
        addresses: of all, by name.
    """

    def __init__(
        self,
        ir: str | Unwritten,
        *functions: str,
        symbols: Mapping[str, int] | None = None,
        optimisation: int = OPTIMISATION,
    ) -> None:
        """symbols: addresses of the text's declarations; cached code refers to them by name, without addresses.

        optimisation: of the code generator, 0 to 3.
        """
        library = binding.JITLibraryBuilder().add_object_img(object_code(ir, optimisation)).add_current_process()
        for name in functions:
            library.export_symbol(name)
        for name, address in (symbols or {}).items():
            library.import_symbol(name, address)
        with _lock:
            serial = next(_serials)
            self._code = library.link(_linker(serial // _LINKS), f"cutpoint{serial}")
        self.addresses: dict[str, int] = {name: self._code[name] for name in functions}
        self.address = self.addresses[functions[0]]


def object_code(ir: str | Unwritten, optimisation: int) -> bytes:
    """A module's object file: from disk if this user has compiled it before for this processor."""
    if not (isinstance(ir, str) or _are_as_loaded()):
        ir = ir.write()
    source = ir if isinstance(ir, str) else repr((ir.by, _writers()))
    kept, key = _cache(user_folder()), key_of(source, str(optimisation), *_surroundings())

    def made() -> bytes:
        with _generator:  # another thread may just have compiled it
            code = kept.read(key)
            if code is None:
                code = _emitted(ir if isinstance(ir, str) else ir.write(), optimisation)
                kept.write(key, code)
        return code

    return kept.read(key) or interruptible(made)


def _emitted(ir: str, optimisation: int) -> bytes:
    context = binding.create_context()
    with binding.parse_assembly(ir, context) as module:
        return _machine(optimisation).emit_object(module)


@cache
def _surroundings() -> tuple[str, ...]:
    """Everything, apart from its text, that determines a module's code."""
    versions = (__version__, llvmlite.__version__, str(binding.llvm_version_info))
    return (*versions, _machine(OPTIMISATION).triple, *_processor(), _RELOCATION, _MODEL)


@cache
def _writers() -> tuple[tuple[str, int, int], ...]:
    """The current contents of the files that write modules: a changed one may write other text.

    Empty where the package is bundled into one file: then the version stands for them.
    """
    kernels = Path(__file__).parents[1]
    found = ((x.relative_to(kernels), x.stat()) for x in kernels.rglob("*.py"))
    return tuple(sorted((str(name), file.st_size, file.st_mtime_ns) for name, file in found))


def _are_as_loaded() -> bool:
    """Whether the writers' files are those that this process has loaded, judging by their times: otherwise its modules
    in memory may write other text."""
    return all(written < LOADED_AT for *_, written in _writers())


def _processor() -> tuple[str, str]:
    return binding.get_host_cpu_name(), binding.get_host_cpu_features().flatten()


@cache
def _cache(folder: Path | None) -> Cache:
    return Cache(folder)


@cache
def _machine(optimisation: int) -> binding.TargetMachine:
    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    cpu, features = _processor()
    return binding.Target.from_default_triple().create_target_machine(
        cpu=cpu, features=features, opt=optimisation, reloc=_RELOCATION, codemodel=_MODEL, jit=True
    )


@lru_cache(maxsize=1)
def _linker(number: int) -> binding.LLJIT:
    """The linkers in rotation; one stays in memory after its turn for the code that it has linked."""
    # code addresses its constants within 2 GiB: JITLink places them next to it, however fragmented memory is; the older
    # linker, which LLVM still prefers on Windows, does not
    return binding.create_lljit_compiler(_machine(OPTIMISATION), use_jit_link=sys.platform != "win32")


@cache
def vector_width() -> int:
    """This processor's vector width, in float64 numbers."""
    features = binding.get_host_cpu_features()
    return 8 if features.get("avx512f") else 4 if features.get("avx2") else 2
