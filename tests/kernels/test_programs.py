"""Stepping programs against a plain Python interpretation of the same loops."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from cutpoint.errors import InputError, TraceError
from cutpoint.kernels import LaneLoop, Loop, Program, Region, Stage, compile_program
from cutpoint.kernels import compile as compile_kernel
from cutpoint.kernels.arrays import backends
from cutpoint.scalars import absolute, exp, sin, where

BACKENDS = ("llvm", "numpy")
H = 0.01
RK4 = [[0.0, H / 6], [H / 2, H / 3], [H / 2, H / 3], [H, H / 6]]
REGIONS = [Region(n, k) for n, k in [("x", 2), ("rate", 2), ("sum", 2), ("rk", 2), ("u", 1), ("fault", 1), ("log", 3)]]


def derivative(x: Any, u: Any) -> Any:
    return [x[1], -4 * sin(x[0]) - x[1] / 10 + u[0]]


def control(x: Any, u: Any) -> Any:
    return [u[0] - x[0] / 100], [where(absolute(x[0]) > 1.5, 1, 0)]


def begin(x: Any) -> Any:
    return [0, 0], x


def stage(x: Any, rate: Any, total: Any, rk: Any, u: Any) -> Any:
    k = derivative([a + rk[0] * b for a, b in zip(x, rate, strict=True)], u)
    return k, [a + rk[1] * b for a, b in zip(total, k, strict=True)]


def end(total: Any) -> Any:
    return total


def record(x: Any, log: Any) -> Any:
    return [x[0], log[1], x[1]]  # the middle slot stays as it is


def pendulum(backend: str, *, substeps: int = 2, ticks: int | str = "ticks") -> Program:
    step = Loop(4, (Stage(stage, ("x", "rate", "sum", "rk", "u"), ("rate", "sum")),), streams=("rk",))
    substep = Loop(substeps, (Stage(begin, ("x",), ("rate", "sum")), step, Stage(end, ("sum",), ("x",))))
    tick = (Stage(control, ("x", "u"), ("u", "fault")), substep, Stage(record, ("x", "log"), ("log",)))
    return compile_program(Loop(ticks, tick, streams=("log",), until="fault"), REGIONS, backend=backend)


def memory(rows: int, start: float = 1.0) -> dict[str, np.ndarray]:
    arrays = {r.name: np.zeros(r.size) for r in REGIONS}
    return arrays | {"x": np.array([start, 0.0]), "rk": np.array(RK4), "log": np.full((rows, 3), 9.0)}


def plainly(ticks: int, memory: dict[str, np.ndarray]) -> int:
    """The same loops in plain Python."""
    x, u = [float(e) for e in memory["x"]], float(memory["u"][0])
    for tick in range(ticks):
        fault, u = float(abs(x[0]) > 1.5), u - x[0] / 100
        for _ in range(2):
            rate, total = [0.0, 0.0], [*x]
            for a, b in RK4:
                y = [p + a * r for p, r in zip(x, rate, strict=True)]
                rate = [y[1], -4 * math.sin(y[0]) - y[1] / 10 + u]
                total = [t + b * r for t, r in zip(total, rate, strict=True)]
            x = total
        memory["log"][tick] = [x[0], memory["log"][tick, 1], x[1]]
        if fault:
            break
    memory |= {"x": np.array(x), "u": np.array([u]), "fault": np.array([fault])}
    return tick + 1


@pytest.fixture(params=BACKENDS)
def program(request: pytest.FixtureRequest) -> Program:
    return pendulum(request.param)


@pytest.mark.parametrize("start", [0.0, 1e-300, 1.0, -1.49])
def test_loops_do_what_they_say(program: Program, start: float) -> None:
    ours, plain = memory(200, start), memory(200, start)
    assert program.run({"ticks": 200}, **ours) == plainly(200, plain)
    for name in ("x", "u", "fault", "log"):
        # 400 substeps of a damped pendulum do not amplify rounding
        np.testing.assert_allclose(ours[name], plain[name], rtol=1e-11, atol=1e-11 * abs(start), err_msg=name)


def test_a_loop_is_left_after_the_iteration_that_says_so(program: Program) -> None:
    ours, plain = memory(2000, 1.499), memory(2000, 1.499)
    ours["u"][0] = plain["u"][0] = 8.0
    done = program.run({"ticks": 2000}, **ours)
    assert done == plainly(2000, plain) < 2000
    assert ours["fault"][0] == 1 and (ours["log"][done:] == 9).all() and (ours["log"][:done, 0] != 9).all()


def test_not_a_number_ends_a_loop() -> None:
    for backend in BACKENDS:
        spin = Loop(10, (Stage(lambda x: [2 * x[0]], ("x",), ("x",)),), until="x")
        x = np.array([math.nan])
        assert compile_program(spin, [Region("x", 1)], backend).run({}, x=x) == 1


def test_no_iterations_touch_nothing(program: Program) -> None:
    arrays = memory(0)
    before = {name: array.copy() for name, array in arrays.items()}
    assert program.run({"ticks": 0}, **arrays) == 0
    assert all(np.array_equal(arrays[name], before[name]) for name in arrays)


def test_a_run_goes_on_where_the_last_one_stopped(program: Program) -> None:
    once, twice = memory(60), memory(60)
    program.run({"ticks": 60}, **once)
    program.run({"ticks": 25}, **twice)
    program.run({"ticks": 35}, **twice | {"log": twice["log"][25:]})
    assert all(np.array_equal(once[name], twice[name]) for name in once)


def test_all_is_read_before_anything_is_written() -> None:
    for backend in BACKENDS:
        swap = Stage(lambda a, b: ([b[1], a[0]], [a[1], a[0]]), ("a", "b"), ("a", "b"))
        a, b = np.array([1.0, 2.0]), np.array([3.0, 4.0])
        compile_program(Loop(1, (swap,)), [Region("a", 2), Region("b", 2)], backend).run({}, a=a, b=b)
        assert a.tolist() == [4, 1] and b.tolist() == [2, 1]


def test_an_inner_stream_begins_anew_and_an_outer_one_stays() -> None:
    digit = Stage(lambda row, col, out: [out[0] * 10 + row[0] * col[0]], ("row", "col", "out"), ("out",))
    outer = Loop("outer", (Loop("inner", (digit,), streams=("col",)),), streams=("row", "out"))
    for backend in BACKENDS:
        program = compile_program(outer, [Region(n, 1) for n in ("row", "col", "out")], backend)
        arrays = {"row": np.array([[1.0], [2.0]]), "col": np.array([[1.0], [2.0], [3.0]]), "out": np.zeros((2, 1))}
        assert program.run({"outer": 2, "inner": 3}, **arrays) == 2
        assert arrays["out"].tolist() == [[123], [246]]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("is_backward", [False, True])
def test_a_stream_of_an_outer_loop_too_has_a_row_for_each_iteration(backend: str, is_backward: bool) -> None:
    sums = Stage(lambda x, total: ([x[0] + total[0]], [x[0] + total[0]]), ("x", "total"), ("x", "total"))
    inner = Loop("inner", (sums,), streams=("x",), backward=is_backward)
    twice = Stage(lambda x: [2 * x[0]], ("x",), ("x",))
    begin = Stage(lambda: [0], (), ("total",))
    body = Loop("outer", (begin, inner, Loop("inner", (twice,), streams=("x",))), streams=("x",))
    program = compile_program(body, [Region("x", 1), Region("total", 1)], backend)
    x = np.arange(1.0, 7)[:, None]
    program.run({"outer": 2, "inner": 3}, x=x, total=np.zeros(1))
    expected = [12, 10, 6, 30, 22, 12] if is_backward else [2, 6, 12, 8, 18, 30]
    assert x[:, 0].tolist() == expected
    with pytest.raises(InputError, match=r"region 'x' streams: .* at least 6 rows of 1"):
        program.run({"outer": 2, "inner": 3}, x=x[:5], total=np.zeros(1))


def test_empty_regions_are_no_special_case() -> None:
    for backend in BACKENDS:
        step = Stage(lambda x, none: ([x[0] + 1], none), ("x", "none"), ("x", "none"))
        program = compile_program(Loop(3, (step,), streams=("none",)), [Region("x", 1), Region("none", 0)], backend)
        x = np.zeros(1)
        program.run({}, x=x, none=np.zeros((3, 0)))
        assert x[0] == 3


def test_what_is_only_read_may_be_read_only() -> None:
    rk = np.array(RK4)
    rk.flags.writeable = False
    assert pendulum("llvm").run({"ticks": 3}, **memory(3) | {"rk": rk}) == 3


def test_auto_takes_llvm_where_it_is_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    assert pendulum("auto").backend == "llvm"
    monkeypatch.setattr(backends, "llvm_is_installed", lambda: False)
    assert pendulum("auto").backend == "numpy"


def strided(name: str) -> np.ndarray:
    return np.zeros((len(memory(9)[name]), 2))[:, 0]


def read_only() -> np.ndarray:
    array = np.zeros(2)
    array.flags.writeable = False
    return array


SHARED = np.zeros(4)
WRONG_ARRAYS: list[tuple[dict[str, Any], str]] = [
    ({"x": np.zeros(3)}, "region 'x' has 2 slots, but its array holds 3 numbers"),
    ({"x": np.zeros(2, np.float32)}, "region 'x' must be an array of float64, not float32"),
    ({"x": np.zeros(2, ">f8")}, "float64"),
    ({"x": [0.0, 0.0]}, "not list"),
    ({"x": strided("x")}, "C-contiguous"),
    ({"x": read_only()}, "read-only"),
    ({"log": np.zeros((8, 3))}, "region 'log' streams: its array has shape (8, 3), but must have at least 9 rows of 3"),
    ({"log": np.zeros(27)}, "at least 9 rows of 3"),
    ({"log": np.zeros((9, 4))}, "at least 9 rows of 3"),
    ({"rk": np.zeros((3, 2))}, "at least 4 rows of 2"),
    ({"x": SHARED[:2], "rate": SHARED[1:3]}, "share memory"),
    ({"y": np.zeros(2)}, "no array is named 'y'"),
]


@pytest.mark.parametrize("case", range(len(WRONG_ARRAYS)))
def test_no_wrong_array_reaches_machine_code(program: Program, case: int) -> None:
    wrong, message = WRONG_ARRAYS[case]
    with pytest.raises(InputError) as caught:
        program.run({"ticks": 9}, **memory(9) | wrong)
    assert message in str(caught.value)


def test_a_run_needs_all_its_arrays_and_counts(program: Program) -> None:
    arrays = memory(9)
    for counts, message in [({}, "'ticks' is missing"), ({"ticks": -1}, "whole"), ({"ticks": 1.5}, "whole")]:
        with pytest.raises(InputError, match=message):
            program.run(counts, **arrays)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="no count is named 'tocks'"):
        program.run({"ticks": 1, "tocks": 1}, **arrays)
    del arrays["u"]
    with pytest.raises(InputError, match="array 'u' is missing"):
        program.run({"ticks": 1}, **arrays)


def keep(x: Any) -> Any:
    return x


COPY = Stage(keep, ("x",), ("x",))
UNSOUND: list[tuple[Callable[[], Loop], type[Exception], str]] = [
    (lambda: Loop(1, (Stage(keep, ("w",), ("x",)),)), InputError, "no region is named 'w'"),
    (lambda: Loop(1, (COPY,), streams=("w",)), InputError, "no region is named 'w'"),
    (lambda: Loop(1, (COPY,), until="x"), InputError, "one slot"),
    (lambda: Loop(1, (COPY,), until="flag", streams=("flag",)), InputError, "one slot"),
    (lambda: Loop(1, (Loop(2, (COPY,), ("x",)), Loop(3, (COPY,), ("x",))), ("x",)), InputError, "the same count"),
    (lambda: LaneLoop(1, (Loop(2, (COPY,), streams=("x",)),), streams=("x",)), InputError, "none must be a LaneLoop"),
    (lambda: Loop(1, (COPY, Loop(2, (COPY,), streams=("x",))), streams=("x",)), InputError, "only be used inside"),
    (lambda: Loop(1, (COPY, Loop(2, (COPY,), streams=("x",)))), InputError, "only be used inside"),
    (lambda: Loop(-1, (COPY,)), InputError, "negative"),
    (lambda: Loop(None, (COPY,)), InputError, "number or a name"),  # type: ignore[arg-type]
    (lambda: Loop(1, (keep,)), InputError, "not a function"),  # type: ignore[arg-type]
    (lambda: Loop(1, (Stage(keep, ("x",), ()),)), InputError, "at least one region"),
    (lambda: Loop(1, (Stage(lambda x: (x, x), ("x",), ("x", "x")),)), InputError, "each only once"),
    (lambda: Loop(1, (Stage(lambda x: x[:1], ("x",), ("x",)),)), TraceError, "returns 1 for region 'x' of 2 slots"),
    (lambda: Loop(1, (Stage(lambda x: x[0], ("x",), ("x",)),)), TraceError, "returns a Traced for region 'x'"),
    (lambda: Loop(1, (Stage(lambda x: x, ("x",), ("x", "flag")),)), TraceError, "returns a Traced for region 'x'"),
    (lambda: Loop(1, (Stage(lambda x: None, ("x",), ("x", "flag")),)), TraceError, "must return 2 lists"),
    (lambda: Loop(1, (Stage(lambda x: [x[0], None], ("x",), ("x",)),)), TraceError, "holds a NoneType"),
    (lambda: Loop(1, (Stage(lambda x: x if x[0] > 0 else [0, 0], ("x",), ("x",)),)), TraceError, "cutpoint.where"),
]


@pytest.mark.parametrize("case", range(len(UNSOUND)))
def test_unsound_programs_are_explained(case: int) -> None:
    loop, kind, message = UNSOUND[case]
    with pytest.raises(kind) as caught:
        compile_program(loop(), [Region("x", 2), Region("flag", 1)])
    assert message in str(caught.value)


def test_regions_have_names_of_their_own() -> None:
    with pytest.raises(InputError, match="different names"):
        compile_program(Loop(1, (COPY,)), [Region("x", 2), Region("x", 1)])


# lanes

LANED = [
    Region("x", 6, 3), Region("v", 3, 3), Region("k", 3, 3), Region("pull", 1), Region("a", 3, 3), Region("held", 2),
]  # fmt: skip


def push(x: Any, v: Any, k: Any, pull: Any, held: Any) -> Any:
    """Of one lane: two numbers of x, one each of v and k, all of the rest."""
    return [sin(x[0]) * exp(k[0] / (1 + held[0])) + x[1] * pull[0] - v[0] * held[1]]


def couple(a: Any, v: Any) -> Any:
    return [(a[0] + a[1] + a[2]) / 8 + v[0], a[1], a[2] - v[1]]


def move(x: Any, v: Any, a: Any) -> Any:
    return [x[0] + H * v[0], x[1] + H * a[0]], [v[0] + H * a[0]]


def springs(lanes: int, backend: str) -> Program:
    """Three like things that feel each other, side by side or one after another."""

    def each(function: Callable[..., Any], mine: int) -> Callable[..., Any]:
        """All three by loops over the first `mine` arguments."""

        def of_all(*regions: Any) -> Any:
            results = [function(*(r[k::3] for r in regions[:mine]), *regions[mine:]) for k in range(3)]
            nested = [r if isinstance(r, tuple) else (r,) for r in results]
            lists = [[x for row in zip(*part, strict=True) for x in row] for part in zip(*nested, strict=True)]
            return lists[0] if len(lists) == 1 else lists

        return of_all if lanes == 1 else function

    body = [
        Stage(each(push, 3), ("x", "v", "k", "pull", "held"), ("a",), lanes),
        Stage(couple, ("a", "v"), ("a",)),
        Stage(each(move, 3), ("x", "v", "a"), ("x", "v"), lanes),
    ]
    return compile_program(Loop("ticks", body), LANED, backend=backend)


@pytest.mark.parametrize("backend", BACKENDS)
def test_lanes_side_by_side_are_lanes_one_after_another_to_the_last_bit(backend: str) -> None:
    rng = np.random.default_rng(0)
    start = {r.name: rng.uniform(0.2, 1.0, r.size) for r in LANED}
    ends = []
    for lanes in (3, 1):
        arrays = {name: x.copy() for name, x in start.items()}
        springs(lanes, backend).run({"ticks": 50}, **arrays)
        ends.append(arrays)
    for name in start:
        np.testing.assert_array_equal(ends[0][name], ends[1][name])
    assert not np.array_equal(ends[0]["x"], start["x"])


def swing(x: Any, own: Any) -> Any:
    """Several numbers that no iteration changes, of each lane its own."""
    return [x[0] + H * x[1] * exp(own[1]), x[1] - H * exp(own[0]) * sin(x[0]) - exp(own[2]) * H * x[1]]


@pytest.mark.parametrize("lanes", [1, 2, 3, 5, 8, 16, 17, 24, 40, 48])
@pytest.mark.parametrize("backend", BACKENDS)
def test_any_number_of_lanes_is_as_many_runs_to_the_last_bit(backend: str, lanes: int) -> None:
    rng = np.random.default_rng(lanes)
    x, own = rng.uniform(-1, 1, 2 * lanes), rng.uniform(-1, 1, 3 * lanes)
    alone = [(x[k::lanes].copy(), own[k::lanes].copy()) for k in range(lanes)]
    regions = [Region("x", 2 * lanes, lanes), Region("own", 3 * lanes, lanes)]
    together = compile_program(Loop("ticks", [Stage(swing, ("x", "own"), ("x",), lanes)]), regions, backend=backend)
    together.run({"ticks": 20}, x=x, own=own)
    regions = [Region("x", 2), Region("own", 3)]
    one = compile_program(Loop("ticks", [Stage(swing, ("x", "own"), ("x",))]), regions, backend=backend)
    for k, (mine, numbers) in enumerate(alone):
        one.run({"ticks": 20}, x=mine, own=numbers)
        np.testing.assert_array_equal(x[k::lanes], mine)


def test_a_laned_stage_writes_only_regions_with_as_many_lanes() -> None:
    body = [Stage(push, ("x", "v", "k", "pull", "held"), ("pull",), 3)]
    with pytest.raises(
        InputError, match=r"a stage of 3 lanes writes region 'pull', which has 1; the numbers must match"
    ):
        compile_program(Loop(1, body), LANED)


def test_a_region_is_whole_in_lanes() -> None:
    with pytest.raises(InputError, match="whole in lanes"):
        compile_program(Loop(1, [Stage(couple, ("a", "v"), ("a",))]), [Region("a", 4, 3), Region("v", 3, 3)])


def test_what_never_changes_is_computed_once_and_to_the_same_bits() -> None:
    """The constant's exponential stands before the loop; a second run with another constant sees it anew."""

    def grow(x: Any, rate: Any) -> Any:
        return [x[0] * exp(rate[0] / 3) + sin(rate[0])]

    program = compile_program(Loop("ticks", [Stage(grow, ("x", "rate"), ("x",))]), [Region("x", 1), Region("rate", 1)])
    one = compile_kernel(grow, x=1, rate=1)
    for rate in (0.1, -0.4):
        x, expected = np.array([1.0]), np.array([1.0])
        program.run({"ticks": 7}, x=x, rate=np.array([rate]))
        for _ in range(7):
            expected = one(expected, np.array([rate]))
        np.testing.assert_array_equal(x, expected)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_condition_on_what_never_changes_chooses_anew_in_each_run(backend: str) -> None:
    def grow(x: Any, rate: Any) -> Any:
        return [where(rate[0] < 0.5, x[0] + 1, x[0] * 2)]

    regions = [Region("x", 1), Region("rate", 1)]
    program = compile_program(Loop("ticks", [Stage(grow, ("x", "rate"), ("x",))]), regions, backend=backend)
    for rate, expected in ((0.1, 4.0), (0.9, 8.0)):
        x = np.array([1.0])
        program.run({"ticks": 3}, x=x, rate=np.array([rate]))
        assert x[0] == expected


@pytest.mark.parametrize("lanes", [1, 3])
@pytest.mark.parametrize("backend", BACKENDS)
def test_what_passes_through_is_as_it_was_before(backend: str, lanes: int) -> None:
    swap = Stage(lambda x, y: (y, x), ("x", "y"), ("x", "y"), lanes)
    regions = [Region("x", 2 * lanes, lanes), Region("y", 2 * lanes, lanes)]
    x, y = np.arange(2.0 * lanes), -np.arange(2.0 * lanes)
    compile_program(Loop(3, [swap]), regions, backend).run({}, x=x, y=y)
    assert np.array_equal(x, -np.arange(2.0 * lanes)) and np.array_equal(y, np.arange(2.0 * lanes))
