"""Latency of an exported function: the longest of very many calls, alone and with another core busy.

python benchmarks/latency.py --function elastic_inverse_dynamics --calls 1e8

Writes the function as C, compiles it with a harness, and runs it: percentiles of single calls from a histogram of clock
ticks, allocations counted by wrapping the allocator, stack by painting it before the first call.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path

import compilers

import cutpoint
from cutpoint.export import export_function

FLAGS = ("-O2", "-march=native", "-ffp-contract=off", "-fno-math-errno", "-std=gnu11")
WRAPPED = ("malloc", "calloc", "realloc")

CALLS = 100_000_000
FUNCTION = "elastic_inverse_dynamics"

CORES = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else []
"""That this process had when it began; the last is the one that is measured on."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--function", default=FUNCTION)
    parser.add_argument("--calls", type=float, default=CALLS)
    parser.add_argument("--compiler", default="gcc")
    given = parser.parse_args()
    found = latency(given.function, int(given.calls), given.compiler)
    if found is None:
        sys.exit(f"{given.compiler} is not installed")
    print(f"{found['function']}, {found['compiler']}, {found['calls']:.0e} calls")
    for x in found["runs"]:
        times = f"p50 {x['p50']} ns, p99.99 {x['p99.99']} ns, max {x['max']} ns"
        print(f"core beside {x['beside']}: {times}; {x['allocations']} allocations; {x['stack']} bytes of stack")


def latency(function: str = FUNCTION, calls: int = CALLS, compiler: str = "gcc") -> dict | None:
    """Runs idle and, where there is a second core, beside it at work; None without the compiler."""
    if not compilers.version(compiler):
        return None
    print(f"{calls:.0e} calls of {function}, one by one", file=sys.stderr)
    with tempfile.TemporaryDirectory() as name:
        program = built(Path(name), function, compiler)
        runs = [{"beside": "idle", **measured(program, calls)}]
        if len(CORES) > 1:
            with busy(CORES[0]):
                runs.append({"beside": "busy", **measured(program, calls)})
    return {"function": function, "calls": calls, "compiler": f"{compiler} {' '.join(FLAGS)}", "runs": runs}


def built(folder: Path, function: str, compiler: str) -> Path:
    """The harness around a function of the paper's arm."""
    export_function(cutpoint.robots.xia2019(), function, folder)
    check = (folder / f"{function}_check.c").read_text()
    (call,) = [line.strip() for line in check.splitlines() if line.strip().startswith(f"{function}(")]
    tables = check[check.index("#define CUTPOINT_CASES") : check.index("static const char *const cutpoint_names")]
    harness = Path(__file__).with_name("latency.c").read_text()
    text = harness.replace("HEADER", f"{function}.h").replace("/* TABLES */", tables).replace("/* CALL */", call)
    (folder / "latency.c").write_text(text)
    wraps = [f"-Wl,--wrap={name}" for name in WRAPPED]
    command = [compiler, *FLAGS, *wraps, "latency.c", f"{function}.c", "-lm", "-o", "latency"]
    subprocess.run(command, cwd=folder, check=True)
    return folder / "latency"


def measured(program: Path, calls: int) -> dict[str, int]:
    """On the last core, where the system lets programs be pinned."""
    with on_core(CORES[-1] if CORES else None):
        found = subprocess.run([program, str(calls)], capture_output=True, text=True, check=True)
    return json.loads(found.stdout)


@contextmanager
def on_core(core: int | None) -> Iterator[None]:
    """This process, and those that it starts, on one core."""
    if core is None:
        yield
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {core})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


@contextmanager
def busy(core: int) -> Iterator[None]:
    """A core that counts."""
    spinning = get_context("spawn").Process(target=spin, args=(core,), daemon=True)
    spinning.start()
    try:
        yield
    finally:
        spinning.terminate()


def spin(core: int) -> None:
    os.sched_setaffinity(0, {core})
    while True:
        pass


if __name__ == "__main__":
    main()
