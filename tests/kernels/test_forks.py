"""A process forked while another thread compiles: nothing that the thread held stays shut in the child."""

import os
import subprocess
import sys

import pytest

from cutpoint.kernels.machine.cache import VARIABLE

PROGRAM = """
import os, signal, threading
import numpy as np
from llvmlite import binding
from cutpoint.kernels import compile
from cutpoint.scalars import sin

def law(factor):
    def terms(x):
        for k in range(100):
            x = sin(x * (factor + k)) + x
        return x
    return compile(terms, x=(), name="law", backend="llvm")

ROWS, STRIDED = np.linspace(0, 1, 5000), np.linspace(0, 1, 5000)[::2]
kernel, emits, emit = law(0.5), threading.Event(), binding.TargetMachine.emit_object

def told(machine, module):
    emits.set()
    return emit(machine, module)

binding.TargetMachine.emit_object = told
thread = threading.Thread(target=lambda: {work})
thread.start()
assert emits.wait(20)
child = os.fork()
if not child:
    signal.alarm(30)
    {work}
    law(0.25)(0.1)
    os._exit(0)
print(os.waitpid(child, 0)[1])
thread.join()
"""


@pytest.mark.parametrize("work", ["kernel(ROWS)", "kernel(STRIDED)", "kernel.blocks"])
def test_a_child_forked_in_mid_compilation_compiles_too(work: str) -> None:
    source, surroundings = PROGRAM.format(work=work), {**os.environ, VARIABLE: ""}
    run = subprocess.run([sys.executable, "-c", source], env=surroundings, timeout=100, capture_output=True, text=True)
    assert (run.stdout, run.returncode) == ("0\n", 0), run.stderr
