"""C and C++ compiled into shared libraries, kept in benchmarks/build, which git ignores."""

import ctypes
import hashlib
import shutil
import subprocess
import sys
import time
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from cutpoint.studies.cost.study import processor

FOLDER = Path(__file__).with_name("build")
FLAGS = ("-O3", "-march=native", "-fPIC", "-shared")


def library(text: str, *, compiler: str = "gcc", suffix: str = ".c", flags: Sequence[str] = (), note: str = "",
            linked: Sequence[str] = ()) -> ctypes.CDLL:  # fmt: skip
    """The text compiled, unless it has been: with these flags, by this version of the compiler, for this processor.

    linked: libraries, which the linker wants behind the text.  note: what else decides what comes out, such as the
    version of headers; where given, a line says what takes so long.
    """
    parts = [text, compiler, version(compiler), *FLAGS, *flags, *linked, note, processor()]
    stem = hashlib.blake2b("\0".join(parts).encode(), digest_size=12).hexdigest()
    made = FOLDER / f"{stem}.so"
    if not made.exists():
        FOLDER.mkdir(exist_ok=True)
        source, unready = made.with_suffix(suffix), made.with_suffix(".unready")
        source.write_text(text)
        start = time.perf_counter()
        if note:
            print(f"compiling for {note} with {compiler}: minutes, once", file=sys.stderr)
        command = [compiler, *FLAGS, *flags, str(source), "-o", str(unready), *linked]
        subprocess.run(command, check=True)
        unready.replace(made)
        if note:
            print(f"compiled in {time.perf_counter() - start:.0f} s", file=sys.stderr)
    return ctypes.CDLL(str(made))


@cache
def version(compiler: str) -> str:
    """What the compiler calls itself; empty where there is none."""
    if not shutil.which(compiler):
        return ""
    found = subprocess.run([compiler, "--version"], capture_output=True, text=True)
    return found.stdout.partition("\n")[0]
