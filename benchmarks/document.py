"""docs/benchmarks.md from the results of a run."""

from collections.abc import Sequence

from function_sections import elastic, from_memory, functions, in_jax, parameters
from goals import goals
from run_sections import chains, closed_loop, large_robots, latency, laws, python_calls, starts, steps
from tables import NONE

_INTRODUCTION = """# Benchmarks

<!-- Written by benchmarks/run.py: change that, and run `make bench`. -->

cutpoint beside Pinocchio, MuJoCo and CasADi's generated C, on robots of the package example-robot-data, in one process
on one core, the contenders in turns on the same random rows; every result agrees to {worst:.0e} of the largest before
anything is timed.  **Only the ratios within a row are claims**: absolute figures move with the machine, its clock and
what else it does.  Times are medians, least in brackets, in nanoseconds; ratios are of the least, which other work
disturbs least.  Each turn begins with a call that is not timed, for others have emptied the caches; runs of commits
before 1ae8b75 were without, which costs batches most.  What a compiler is missing for shows as {none}.  Processors go
by what a virtual machine shows of them, and in brackets by what LLVM takes them for: the one called rocketlake has
units for matrices, which only later ones have.

| | |
|-|-|
| processor | {processor}, core {core} |
| system | {system}, Python {versions[Python]} |
| commit | {commit} |
| versions | {packages} |
| compilers | {compilers} |
| flags | C: {flags}; cutpoint's own C: also {own_flags}; C++: also {cpp_flags} |
| multiply-adds | {flops:.0f} GFLOP/s at most, measured in this run |
| memory | copies {copy:.1f} GB/s, read and written; stores into as much as a batch takes {store:.0f} GB/s |

*Pinocchio C++* is the quickest of its wheel's library, which takes many rows a call in two of the tasks, and of its
headers compiled here by gcc and by clang, with either convention where it offers two.  *MuJoCo C* runs no more of its
stages than a task needs.  *CasADi* is SX functions written for this purpose with the robot's zeros structural, compiled
by gcc as C with a plain loop around; *lean* is the same on the frames and base parameters that cutpoint finds, which
CasADi cannot find by itself.  Orocos KDL is no contender: PyPI has its Python bindings as source only, for an installed
KDL.
"""


def document(results: dict, others: Sequence[dict] = ()) -> str:
    """others: results on other processors, of which the goals are shown."""
    machine, limits = results["machine"], results["limits"]
    packages = ", ".join(f"{name} {number}" for name, number in machine["versions"].items() if name != "Python")
    facts = {
        **machine, "flags": " ".join(machine["flags"]), "own_flags": " ".join(machine["own_flags"]),
        "cpp_flags": " ".join(machine["cpp_flags"]), "compilers": "; ".join(machine["compilers"]) or "none",
        "flops": limits["flops"] / 1e9, "copy": limits["copy"] / 1e9, "store": limits["store"] / 1e9,
    }  # fmt: skip
    tables = [
        goals(results, others), functions(results["tasks"], limits), elastic(results["elastic"]),
        parameters(results["parameters"]),
        from_memory(results["from memory"], limits), in_jax(results["in JAX"]),
        chains(results["chains"]), large_robots(results["large robots"]),
        python_calls(results["from Python"]),
        closed_loop(results["closed loop"], results["own arm"]), steps(results["steps"]), laws(results["laws"]),
        starts([results, *others]), latency(results["latency"]),
    ]  # fmt: skip
    head = _INTRODUCTION.format(**facts, packages=packages, worst=_worst(results), none=NONE)
    return head + "".join(f"\n{text}" for text in tables if text)


def _worst(results: dict) -> float:
    """The largest difference there was, of all that is measured as a share of the largest result."""
    measured = [
        *results["tasks"],
        *results["elastic"],
        *results["parameters"],
        *results["in JAX"],
        *results["chains"]["long"],
        *results["large robots"],
    ]
    return max(x for row in measured for x in row["differences"].values())
