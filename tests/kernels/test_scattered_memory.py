"""Machine code where the address space is full of holes, as in processes that have run for long."""

import subprocess
import sys

PROGRAM = """
import ctypes, mmap
from cutpoint.kernels import compile

KIND, PAGE, GIB = mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS | 0x4000, mmap.PAGESIZE, 2**30  # 0x4000: takes no memory
libc, whole = ctypes.CDLL(None), ctypes.c_size_t
libc.mmap.restype, libc.mmap.argtypes = whole, [whole, whole, ctypes.c_int, ctypes.c_int, ctypes.c_int, ctypes.c_long]
libc.munmap.argtypes = [whole, whole]

def taken(size):
    return libc.mmap(0, size, 0, KIND, -1, 0)

def law(x):
    return 1.25 * x + 3.5  # two numbers that stand beside the code

compile(law, name="first", x=(), backend="llvm")
blocks = [taken(3 * GIB) for _ in range(20)]
for size in (GIB >> 4, GIB >> 8, GIB >> 12, PAGE):  # all smaller gaps above
    while taken(size) > min(blocks):
        pass
for block in blocks:
    libc.munmap(block + GIB, PAGE)
for k in range(10):
    assert compile(law, name=f"law{k}", x=(), backend="llvm")(2.0) == 6.0
"""


def test_code_runs_where_single_pages_lie_gigabytes_apart():
    """A page for the code, and one for its constants, would be there; they are too far apart for one instruction."""
    done = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
