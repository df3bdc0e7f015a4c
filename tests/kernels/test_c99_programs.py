"""Programs in C: loops around stages, with the bits of the same loops in machine code."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from test_lane_loops import LANES, memory, program
from test_programs import memory as of_pendulum
from test_programs import pendulum
from test_triples import dot, run, stage_of

from c_builds import CFunction, assert_same_bits, compilers
from cutpoint.errors import InputError
from cutpoint.kernels import LaneLoop, Loop, Region, Stage, View, compile_program
from cutpoint.kernels.programs.outputs import Fixed, Output, Part, whole
from cutpoint.kernels.targets.c99_package import write_source
from cutpoint.kernels.targets.c99_program import MOST_STACK, source_of
from cutpoint.scalars import sin, sqrt

BOTH = pytest.mark.parametrize("compiler", compilers())


def in_c(fixed: Fixed, folder: Path, compiler: str) -> CFunction:
    """The function of its inputs and outputs, whose check records what machine code gives for two cases."""

    def computed(*given: np.ndarray) -> tuple[np.ndarray, ...]:
        found = [np.empty((len(given[0]), *x.shape)) for x in fixed.outputs.values()]
        for k in range(len(given[0])):
            for one, x in zip(found, of_machine(fixed, *(y[k] for y in given)), strict=True):
                one[k] = x
        return tuple(found)

    source = source_of(fixed, "f")
    write_source(source, computed, "f", folder)
    return CFunction(folder, "f", source, compiler, flags=("-O2",))


def of_machine(fixed: Fixed, *given: np.ndarray) -> list[np.ndarray]:
    """The same by machine code, on memory as it was before a run."""
    arrays = {name: x.copy() for name, x in fixed.arrays.items()}
    for x, numbers in zip(fixed.inputs.values(), given, strict=True):
        (part,) = x.parts
        moved(part, fixed, arrays)[...] = numbers
    compile_program(fixed.plan.body, [*fixed.plan.regions.values()]).run(fixed.counts, **arrays)
    found = []
    for x in fixed.outputs.values():
        Output(x.shape, [Part(moved(p, fixed, arrays), p.index) for p in x.parts]).put(out := np.empty(x.shape))
        found.append(out)
    return found


def moved(part: Part, fixed: Fixed, arrays: Mapping[str, np.ndarray]) -> np.ndarray:
    """The same stretch of copies of the arrays."""
    (name,) = [name for name, x in fixed.arrays.items() if np.shares_memory(x, part.own)]
    first = (part.own.ctypes.data - fixed.arrays[name].ctypes.data) // 8
    room = arrays[name].reshape(-1)[first:]
    return np.lib.stride_tricks.as_strided(room, part.own.shape, part.own.strides)


@BOTH
@pytest.mark.parametrize(("start", "force", "ends"), [(1e-300, 0.0, False), (1.0, 0.0, False), (1.499, 8.0, True)])
def test_nested_loops_that_end_early(start: float, force: float, ends: bool, compiler: str, tmp_path: Path) -> None:
    arrays = of_pendulum(300)
    inputs, outputs = {"start": whole(arrays["x"]), "force": whole(arrays["u"])}, {"log": whole(arrays["log"])}
    fixed = Fixed(pendulum("llvm").plan, {"ticks": 300}, arrays, inputs, outputs)
    given = np.array([start, 0.0]), np.array([force])
    (found,) = in_c(fixed, tmp_path, compiler)(*given)
    (expected,) = of_machine(fixed, *given)
    assert_same_bits(found, expected)
    assert (found[-1] == 9.0).all() == ends  # what an early end leaves as it was


@BOTH
@pytest.mark.parametrize("is_backward", [False, True])
def test_streams_of_nested_loops(is_backward: bool, compiler: str, tmp_path: Path) -> None:
    sums = Stage(lambda x, total: ([x[0] + total[0]], [sin(x[0]) + total[0]]), ("x", "total"), ("x", "total"))
    inner = Loop("inner", [sums], ("x",), backward=is_backward)
    made = compile_program(Loop("outer", [Loop(1, [inner])], ("x",)), [Region("x", 1), Region("total", 1)])
    x = np.zeros((6, 1))
    fixed = Fixed(made.plan, {"outer": 2, "inner": 3}, {"x": x, "total": np.zeros(1)}, {"x": whole(x)}, {"y": whole(x)})
    given = np.random.default_rng(0).normal(size=(6, 1))
    (found,) = in_c(fixed, tmp_path, compiler)(given)
    (expected,) = of_machine(fixed, given)
    assert_same_bits(found, expected)
    assert len(set(expected[:, 0])) == 6


@BOTH
@pytest.mark.parametrize("n", [1, 4, 31])
def test_lanes_trees_and_outputs_in_parts(n: int, compiler: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(n)
    arrays = memory(n, rng.normal(size=(n, 2)))
    arrays["parents"] = np.array([n if i == 0 else rng.integers(0, i) for i in range(n)], np.int64)
    total = arrays["total"].reshape(-1, 2, LANES).swapaxes(1, 2)
    full, rest = n // LANES, n % LANES
    parts = [Part(total[:full], np.s_[: full * LANES]), Part(total[full, :rest], np.s_[full * LANES :])]
    counts = {"blocks": -(-n // LANES), "nodes": n}
    first = arrays["x"].reshape(-1)[: 2 * LANES].reshape(2, LANES)
    outputs = {"total": Output((n, 2), [part for part in parts if part.own.size])}
    fixed = Fixed(program("llvm").plan, counts, arrays, {"first": whole(first)}, outputs)
    function = in_c(fixed, tmp_path, compiler)
    for scale in (0.0, 1e-300, 1.0, 1e5):
        x = scale * rng.normal(size=(2, LANES))
        assert_same_bits(function(x)[0], of_machine(fixed, x)[0])


@BOTH
@pytest.mark.parametrize(
    "recipe", [["crossed", "squared", "along"], ["divided", "column", "flat"], ["mixed", "shared"]]
)
def test_threes(recipe: list[str], compiler: str, tmp_path: Path) -> None:
    rng, n = np.random.default_rng(1), 9
    steps = [(name, 2 * k, 3 * k + 1) for k, name in enumerate(recipe)]
    parents = np.array([n, *(rng.integers(0, i) for i in range(1, n))], np.int64)
    x, s = rng.normal(size=(n + 1, 6)), rng.normal(size=(n, 2))
    loop = LaneLoop(
        "bodies",
        [Stage(stage_of(steps), ("x", "above", "s"), ("x", "s"))],
        ("x", "s"),
        views=[View("above", "x", "parents")],
    )
    made = compile_program(Loop(1, [loop]), [Region("x", 6, triples=True), Region("s", 2)])
    rows = np.zeros((n + 1, 2, 4))
    rows[:, :, :3] = x.reshape(-1, 2, 3)
    arrays = {"x": rows.reshape(-1, 8), "s": np.zeros((n, 2)), "parents": parents}
    outputs = {"threes": Output((n + 1, 2, 3), [Part(rows[:, :, :3])]), "found": whole(arrays["s"])}
    fixed = Fixed(made.plan, {"bodies": n}, arrays, {"s": whole(arrays["s"])}, outputs)
    threes, found = in_c(fixed, tmp_path, compiler)(s)
    expected, numbers = run(steps, parents, x, s, "llvm")
    assert_same_bits(threes.reshape(-1, 6), expected)
    assert_same_bits(found, numbers)


def test_a_program_larger_than_a_stack_is_refused() -> None:
    made = compile_program(Loop(1, [Stage(lambda x: [2 * x[0]], ("x",), ("x",))], ("x",)), [Region("x", 1)])
    arrays = {"x": np.zeros((MOST_STACK // 8 + 1, 1))}
    fixed = Fixed(made.plan, {}, arrays, {"x": whole(arrays["x"][0])}, {"y": whole(arrays["x"][0])})
    with pytest.raises(InputError, match=r"f: in C it would take 4,194,312 bytes of stack, more than 4,194,304"):
        source_of(fixed, "f")


@BOTH
def test_only_what_is_used_is_declared(compiler: str, tmp_path: Path) -> None:
    stage = Stage(lambda a, b: [sqrt(dot(a, a)) + sin(a[0])], ("a", "unread"), ("root",))
    loop = Loop(2, [stage], ("a", "root"), views=[View("unread", "b", "rows")])
    made = compile_program(loop, [Region("a", 3), Region("b", 1), Region("root", 1)])
    arrays = {"a": np.zeros((2, 3)), "b": np.zeros((2, 1)), "root": np.zeros((2, 1)), "rows": np.zeros(2, np.int64)}
    fixed = Fixed(made.plan, {}, arrays, {"a": whole(arrays["a"])}, {"root": whole(arrays["root"])})
    given = np.random.default_rng(0).normal(size=(2, 3))
    assert_same_bits(in_c(fixed, tmp_path, compiler)(given)[0], of_machine(fixed, given)[0])
