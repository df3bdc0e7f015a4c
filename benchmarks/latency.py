"""How long a call of an exported function takes, the worst of very many, alone and beside a busy core.

python benchmarks/latency.py --function elastic_inverse_dynamics --calls 1e8

Writes the function as C, compiles it with a harness, and runs it: percentiles of single calls from a histogram of clock
ticks, allocations counted by wrapping the allocator, stack by painting it before the first call.
"""

import argparse
import shutil
import subprocess
import tempfile
from multiprocessing import Process
from pathlib import Path

import cutpoint
from cutpoint.export import export_function

FLAGS = ("-O2", "-march=native", "-ffp-contract=off", "-fno-math-errno", "-std=gnu11")
WRAPPED = ("malloc", "calloc", "realloc")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--function", default="elastic_inverse_dynamics")
    parser.add_argument("--calls", type=float, default=1e7)
    parser.add_argument("--compiler", default="cc")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        program = built(Path(name), given.function, given.compiler)
        print(f"{given.function}, {given.compiler} {' '.join(FLAGS)}")
        for title, busy in (("idle", False), ("beside a busy core", True)):
            print(f"{title:20s}", measured(program, int(given.calls), busy))


def built(folder: Path, function: str, compiler: str) -> Path:
    """The harness around a function of the paper's arm."""
    export_function(cutpoint.robots.xia2019(), function, folder)
    header = (folder / f"{function}.h").read_text()
    check = (folder / f"{function}_check.c").read_text()
    (call,) = [line.strip() for line in check.splitlines() if line.strip().startswith(f"{function}(")]
    tables = check[check.index("#define CASES") : check.index("static const char *const names")]
    harness = Path(__file__).with_name("latency.c").read_text()
    text = harness.replace("HEADER", f"{function}.h").replace("/* TABLES */", tables).replace("/* CALL */", call)
    assert call.split("(")[0] in header
    (folder / "latency.c").write_text(text)
    wraps = [f"-Wl,--wrap={name}" for name in WRAPPED]
    command = [shutil.which(compiler) or compiler, *FLAGS, *wraps, "latency.c", f"{function}.c", "-lm", "-o", "latency"]
    subprocess.run(command, cwd=folder, check=True)
    return folder / "latency"


def measured(program: Path, calls: int, busy: bool) -> str:
    spinning = Process(target=spin, daemon=True)
    if busy:
        spinning.start()
    try:
        return subprocess.run([program, str(calls)], capture_output=True, text=True, check=True).stdout.strip()
    finally:
        if busy:
            spinning.terminate()


def spin() -> None:
    while True:
        pass


if __name__ == "__main__":
    main()
