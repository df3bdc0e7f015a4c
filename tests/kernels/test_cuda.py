"""CUDA C: it compiles for the GPUs that there are, rounds as machine code does, and is launched with the right rows.

No GPU is needed, and none is tested: NVRTC compiles, a C++ compiler runs the same text, and CuPy has a stand-in.
"""

import re
import sys
from collections import namedtuple
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from cuda_builds import CpuKernel, compiled, rows_of
from test_c99 import EDGES, NAMES, every_operation
from typer.testing import CliRunner

import cutpoint
from c_builds import assert_same_bits
from cutpoint import InputError
from cutpoint.commands import app
from cutpoint.export import export_function
from cutpoint.functions.facts import FACTS
from cutpoint.kernels import Kernel, compile
from cutpoint.kernels.graphs.nodes import CONDITIONS, PRIMITIVES
from cutpoint.kernels.lowering.lower import lower
from cutpoint.kernels.targets import cuda
from robot_library import shoulder

ARCHITECTURES = ("sm_80", "sm_90")


def written(kernel: Kernel, folder: Path) -> str:
    kernel.to_cuda(folder)
    return (folder / f"{kernel.name}.cu").read_text()


def arm_kernel(function: str) -> Kernel:
    arm = cutpoint.robots.xia2019()
    getattr(arm, function)(*np.zeros((5 if "elastic" in function else 3, 6)))
    return arm.kernel(function)


@pytest.mark.parametrize("architecture", ARCHITECTURES)
@pytest.mark.parametrize("function", ["every_operation", "inverse_dynamics", "elastic_inverse_dynamics"])
def test_ptx_rounds_where_the_graph_does_and_nowhere_else(function: str, architecture: str, tmp_path: Path) -> None:
    kernel = compile(every_operation, x=3, k=()) if function == "every_operation" else arm_kernel(function)
    ptx, machine_code = compiled(written(kernel, tmp_path), architecture)
    assert f".target {architecture}" in ptx and f".visible .entry {kernel.name}(" in ptx
    assert machine_code[:4] == b"\x7fELF"
    arithmetic = re.findall(r"\b(?:add|sub|mul|div|fma|mad|sqrt|rcp)\.\S*f64", ptx)
    assert arithmetic and all(".rn." in instruction for instruction in arithmetic)
    fused = sum(lower(kernel.graph).operations.get(op, 0) for op in ("fma", "fms", "fnma"))
    assert 0 < sum(instruction.startswith("fma") for instruction in arithmetic) <= fused
    assert ".local" not in ptx and ".f32" not in ptx


CHOICES = {
    "low": lambda x: cutpoint.where(x < 0.0, x, 0.0), "least": lambda x: cutpoint.minimum(0.0, x),
    "negated": lambda x: cutpoint.where(~(x < 0), 0.0, x), "high": lambda x: cutpoint.where(x > -0.0, x, -0.0),
    "limited": lambda x: cutpoint.clip(x, -1.0, 0.0),
}  # fmt: skip


def choices(x: Any) -> Any:
    return [choice(x) for choice in CHOICES.values()]


def test_a_choice_is_no_minimum_which_would_tell_zeros_apart(tmp_path: Path) -> None:
    for kernel in (double := compile(choices, x=(), backend="llvm")), double.float32:
        folder = tmp_path / kernel.graph.precision.c
        text = written(kernel, folder)
        for architecture in ARCHITECTURES:
            assert not re.search(r"\b(min|max)\.f", compiled(text, architecture)[0])
        x = np.array([0.0, -0.0, 1.0, -1.0, np.nan], kernel.graph.precision.dtype)
        assert_same_bits(rows_of(CpuKernel(folder, "choices"), kernel.graph, x)[0], kernel(x))


def test_functions_share_a_source_file(tmp_path: Path) -> None:
    made = [compile(every_operation, x=3, k=(), name=name) for name in ("first", "second")]
    texts = [written(kernel, tmp_path) for kernel in (*made, compile(every_operation, x=3, k=(), name="third").float32)]
    assert ".entry third(" in compiled("\n".join(texts), "sm_90")[0]


def test_nothing_is_flushed_to_zero(tmp_path: Path) -> None:
    text = written(compile(every_operation, x=3, k=()).float32, tmp_path)
    assert ".ftz" not in compiled(text, "sm_90")[0] and ".ftz" in compiled(text, "sm_90", "--ftz=true")[0]
    assert "without -ftz=true and --use_fast_math" in (tmp_path / "every_operation.cuh").read_text()


def test_plain_arithmetic_would_be_contracted() -> None:
    source = 'extern "C" __global__ void f(double *x) {{ x[0] = {}; }}'
    assert "fma.rn.f64" in compiled(source.format("x[1] * x[2] + x[3]"), "sm_90")[0]
    assert "fma" not in compiled(source.format("__dadd_rn(__dmul_rn(x[1], x[2]), x[3])"), "sm_90")[0]


def test_every_primitive_can_be_said_in_cuda() -> None:
    assert set(PRIMITIVES) == {"input", *cuda._FORMS, *cuda._HELPERS} and set(cuda._FORMS) >= CONDITIONS


def test_every_operation_has_the_bits_of_machine_code(tmp_path: Path) -> None:
    kernel = compile(every_operation, x=3, k=(), backend="llvm")
    written(kernel, tmp_path)
    rng = np.random.default_rng(1)
    x = np.concatenate([rng.choice(EDGES, (300, 3)), rng.normal(size=(300, 3)) * 10.0 ** rng.integers(-3, 4, (300, 1))])
    k = rng.choice(EDGES, 600)
    assert_same_bits(rows_of(CpuKernel(tmp_path, kernel.name), kernel.graph, x, k)[0], kernel(x, k))


def test_no_thread_beyond_the_count_writes(tmp_path: Path) -> None:
    kernel = compile(lambda x: x * 2, name="twice", x=())
    written(kernel, tmp_path)
    x, out = np.arange(5.0), np.full(8, np.pi)
    CpuKernel(tmp_path, "twice")((2,), (4,), (np.int64(5), x, np.int64(1), out))
    assert out.tolist() == [0.0, 2.0, 4.0, 6.0, 8.0, np.pi, np.pi, np.pi]


def table(x: Any, k: Any) -> Any:
    """Long rows: results that are there at once, early, late, twice, and never computed."""
    powers = [x]
    for _ in range(40):
        powers.append(cutpoint.sin(powers[-1] * k))
    return Table([powers[::-1], powers], [1.5, *powers[3:7]], powers[20], [[], []], [powers[-1]] * 33)


Table = namedtuple("Table", "matrix few number none same")


@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_long_rows_leave_whole_and_nothing_beside_them(precision: str, tmp_path: Path) -> None:
    kernel = compile(table, x=(), k=(), backend="llvm")
    kernel = kernel if precision == "float64" else kernel.float32
    text = written(kernel, tmp_path)
    assert "__shared__" in text and "matrix[" not in text
    compiled(text, "sm_90")
    launched, k = CpuKernel(tmp_path, kernel.name), np.ones(1, precision)
    for count in (1, 31, 32, 33, 128, 300):
        x = np.random.default_rng(count).normal(size=count).astype(precision)
        expected = [y for y in kernel(x, k[0]) if y.size]
        for ours, theirs in zip(rows_of(launched, kernel.graph, x, k), expected, strict=True):
            assert_same_bits(ours, theirs)


def test_the_code_includes_and_calls_nothing(tmp_path: Path) -> None:
    text = written(compile(every_operation, x=3, k=()), tmp_path)
    assert "#include" not in text
    called = set(re.findall(r"\b(\w+)\(", text.partition("*/")[2])) - {"if", "every_operation"}
    assert {name for name in called if not name.startswith("cutpoint_")} == {
        "__dadd_rn", "__dsub_rn", "__dmul_rn", "__ddiv_rn", "__dsqrt_rn", "__fma_rn", "__double_as_longlong",
        "__longlong_as_double", "__launch_bounds__", "__syncwarp", "asm",
    }  # fmt: skip


@pytest.mark.parametrize(("name", "argument"), [*NAMES, ("law", "count"), ("law", "threadIdx"), ("law", "cutpoint")])
def test_names_that_cuda_cannot_take_are_refused(name: str, argument: str, tmp_path: Path) -> None:
    kernel = compile(lambda **given: given[argument] * 2, name=name, **{argument: ()})
    with pytest.raises(
        InputError, match=r"cannot be a name in C|is a name that CUDA or the kernel itself already uses"
    ):
        kernel.to_cuda(tmp_path)
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize("name", ["sin", "norm", "rsqrtf", "umin", "max", "normcdfinv", "dim3", "float3", "warpSize"])
def test_a_function_is_not_called_as_one_of_cuda_is(name: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"already uses this name: rename it"):
        compile(lambda x: x * 2, name=name, x=()).to_cuda(tmp_path)
    assert not [*tmp_path.iterdir()]


def test_a_function_without_numbers_is_no_kernel_of_cuda(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"nothing: it returns no numbers; return at least one"):
        compile(lambda x: [], name="nothing", x=2).to_cuda(tmp_path)
    assert not [*tmp_path.iterdir()]


def test_an_input_named_as_anothers_step_is_refused(tmp_path: Path) -> None:
    kernel = compile(lambda q, q_step: q * q_step, name="law", q=(), q_step=())
    with pytest.raises(InputError, match="'q_step' is a name that CUDA or the kernel itself already uses"):
        kernel.to_cuda(tmp_path)


def test_unused_and_empty_arguments_compile(tmp_path: Path) -> None:
    kernel = compile(lambda a, b, c, d: ([1.5, b, -float("inf")]), name="idle", a=4, b=(), c=0, d=())
    text = written(kernel, tmp_path)
    compiled(text, "sm_80")
    rows = [np.ones((3, 4)), np.arange(3.0), np.ones(1)]
    found = rows_of(CpuKernel(tmp_path, "idle"), kernel.graph, *rows)[0]
    assert found.tolist() == [[1.5, b, -np.inf] for b in range(3)]
    compiled(written(compile(lambda: 2.0, name="two"), tmp_path), "sm_80")


def test_only_our_own_files_are_overwritten_unless_forced(tmp_path: Path) -> None:
    kernel = compile(lambda q: q * 2, name="law", q=())
    kernel.to_cuda(tmp_path)
    kernel.to_cuda(tmp_path)
    (tmp_path / "law.cuh").write_text("mine\n")
    with pytest.raises(InputError, match=r"law.cuh' was not written by cutpoint; .* or use force=True"):
        compile(lambda q: q * 3, name="law", q=()).to_cuda(tmp_path)
    assert "0x1.0000000000000p+1" in (tmp_path / "law.cu").read_text()
    assert kernel.to_cuda(tmp_path, force=True) == (tmp_path / "law.cu", tmp_path / "law.cuh")
    with pytest.raises(InputError, match=r"^folder '.*law.cu' is not a folder"):
        kernel.to_cuda(tmp_path / "law.cu")


@pytest.mark.parametrize("function", FACTS)
def test_every_function_of_a_robot_exports_to_cuda(function: str, tmp_path: Path) -> None:
    options = {"frame": "link3"} if function in ("jacobian", "frame_pose", "frame_acceleration") else {}
    paths = export_function(shoulder(), function, tmp_path, to="cuda", name="f", **options)
    code, header = (path.read_text() for path in paths)
    compiled(code, "sm_90")
    head = code[code.index('extern "C"') :].partition(" {\n")[0].replace("__launch_bounds__(128) ", "")
    assert f"{head};" in header and f"{function} of xia2019" in header


def test_the_command_line_exports_to_cuda(tmp_path: Path) -> None:
    done = CliRunner().invoke(
        app, ["export", "xia2019", "--function", "elastic_inverse_dynamics", "--to", "cuda", str(tmp_path)]
    )
    assert done.exit_code == 0, done.output
    header = (tmp_path / "elastic_inverse_dynamics.cuh").read_text()
    numbers = re.findall(r"^  (\S+), /\*", header, re.MULTILINE)
    values = [float.fromhex(x.replace("HUGE_VAL", "inf").strip("()")) for x in numbers]
    assert values == cutpoint.robots.xia2019().drive_parameters.tolist()
    compiled(header, "sm_90")


def test_an_unknown_target_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no target of export is named 'rust'; there are: 'c', 'cuda'"):
        export_function(cutpoint.robots.xia2019(), "gravity_forces", tmp_path, to="rust")


class StandIn:
    """CuPy as far as we use it, on this processor: NumPy's arrays, and kernels that a C++ compiler builds."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.launches, self.compiled, self.__version__ = folder, [], [], "0"
        self.asarray, self.empty, self.reshape = np.asarray, np.empty, np.reshape
        self.broadcast_to, self.ascontiguousarray = np.broadcast_to, np.ascontiguousarray
        self.cuda = SimpleNamespace(
            Module=lambda: StandInModule(self), Device=lambda: SimpleNamespace(compute_capability="90"),
            nvrtc=SimpleNamespace(getVersion=lambda: (12, 9)), runtime=SimpleNamespace(getDevice=lambda: 0),
            compiler=SimpleNamespace(compile_using_nvrtc=self.compile_using_nvrtc),
        )  # fmt: skip

    def compile_using_nvrtc(self, code: str, options: tuple[str, ...]) -> tuple[bytes, None]:
        self.compiled.append(options)
        return code.encode(), None


class StandInModule:
    def __init__(self, cupy: StandIn) -> None:
        self.cupy = cupy

    def load(self, compiled: bytes) -> None:
        self.code = compiled.decode()

    def get_function(self, name: str) -> Any:
        (self.cupy.folder / f"{name}.cu").write_text(self.code)
        kernel = CpuKernel(self.cupy.folder, name)

        def launch(blocks: Any, threads: Any, arguments: Any) -> None:
            self.cupy.launches.append((blocks, threads, arguments))
            kernel(blocks, threads, arguments)

        return launch


@pytest.fixture
def stand_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> StandIn:
    made = StandIn(tmp_path)
    monkeypatch.setitem(sys.modules, "cupy", made)
    return made


Both = namedtuple("Both", "row number")


def both(q: Any, v: Any, M: Any) -> Both:
    return Both([cutpoint.sin(q[0]) * v, q[1] + M[1][2], 2.5], v * M[0][0])


SHAPES = [
    ((), (), ()), ((300,), (), ()), ((300,), (300,), (300,)), ((2, 1), (3,), ()), ((1,), (1,), (1,)), ((0,), (), ()),
    ((), (4,), (1, 1)),
]  # fmt: skip


@pytest.mark.parametrize(("q", "v", "M"), SHAPES)
def test_a_launch_gives_every_thread_its_rows(stand_in: StandIn, q: Any, v: Any, M: Any) -> None:
    kernel, rng = compile(both, q=2, v=(), M=(2, 3), backend="llvm"), np.random.default_rng(0)
    given = [rng.normal(size=(*batch, *own)) for batch, own in ((q, (2,)), (v, ()), (M, (2, 3)))]
    found, expected = kernel.on_gpu()(given[0], M=given[2], v=given[1]), kernel(*given)
    assert found._fields == expected._fields
    for ours, theirs in zip(found, expected, strict=True):
        assert_same_bits(ours, theirs)


def test_what_all_threads_share_is_not_copied(stand_in: StandIn) -> None:
    kernel = compile(both, q=2, v=(), M=(2, 3))
    kernel.on_gpu()(np.zeros((300, 2)), np.zeros(300), np.ones((2, 3)))
    ((blocks, threads, arguments),) = stand_in.launches
    assert blocks == (3,) and threads == (128,) and arguments[0] == 300
    assert [int(step) for step in arguments[2:7:2]] == [2, 1, 0] and arguments[5].size == 6


def test_a_second_process_finds_what_was_compiled(
    stand_in: StandIn, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CUTPOINT_CACHE", str(tmp_path / "kept"))
    kernel = compile(both, q=2, v=(), M=(2, 3))
    for function in kernel.on_gpu(), kernel.on_gpu():
        function(np.zeros(2), 0.0, np.zeros((2, 3)))
        function(np.zeros((4, 2)), 0.0, np.zeros((2, 3)))
    assert stand_in.compiled == [("--std=c++17",)] and len(stand_in.launches) == 4


def test_strided_arrays_are_tidied(stand_in: StandIn) -> None:
    kernel, x = compile(lambda q: q[0] - q[1], q=2), np.arange(40.0).reshape(2, 20).T
    assert_same_bits(kernel.on_gpu()(x[::2]), kernel(x[::2]))


def test_a_launch_in_single_precision_gives_the_bits_of_machine_code(stand_in: StandIn) -> None:
    kernel, rng = compile(both, q=2, v=(), M=(2, 3), backend="llvm").float32, np.random.default_rng(0)
    given = [rng.normal(size=(300, *own)) for own in ((2,), (), (2, 3))]
    for ours, theirs in zip(kernel.on_gpu()(*given), kernel(*given), strict=True):
        assert ours.dtype == np.float32
        assert_same_bits(ours, theirs)


def test_shapes_that_do_not_fit_are_refused(stand_in: StandIn) -> None:
    function = compile(both, name="law", q=2, v=(), M=(2, 3)).on_gpu()
    with pytest.raises(InputError, match=r"law: q has shape \(3,\): its last axis must be 2"):
        function(np.zeros(3), 0.0, np.zeros((2, 3)))
    with pytest.raises(InputError, match=r"law: leading axes do not broadcast: q \(4,\), v \(3,\), M \(\)"):
        function(np.zeros((4, 2)), np.zeros(3), np.zeros((2, 3)))
    with pytest.raises(InputError, match="law: M missing; it takes q, v, M"):
        function(np.zeros(2), 0.0)


MASKED = np.ma.array([1.0, 2.0], mask=[True, False])
WRONG = [
    (MASKED, "q has masked numbers"), (["1", "2"], "q holds <U1, but must hold real numbers"),
    (np.zeros(2, "M8[s]"), "q holds datetime64"), ([[1], [2, 3]], "q is not an array"),
    ([10**400, 1], "q holds Python objects"),
]  # fmt: skip


@pytest.mark.parametrize(("q", "told"), WRONG)
def test_what_holds_no_numbers_is_refused(stand_in: StandIn, q: Any, told: str) -> None:
    with pytest.raises(InputError, match=f"both: {told}"):
        compile(both, q=2, v=(), M=(2, 3)).on_gpu()(q, 0.0, np.zeros((2, 3)))


class Elsewhere(np.ndarray):
    """An array of another GPU."""

    __cuda_array_interface__ = {}  # noqa: RUF012
    device = SimpleNamespace(id=1)


def test_an_array_on_another_gpu_is_refused(stand_in: StandIn) -> None:
    with pytest.raises(InputError, match=r"both: q is on GPU 1, but GPU 0 is in use: move it, or call within"):
        compile(both, q=2, v=(), M=(2, 3)).on_gpu()(np.zeros(2).view(Elsewhere), 0.0, np.zeros((2, 3)))


def test_what_does_not_load_is_not_kept_and_compiled_anew(
    stand_in: StandIn, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CUTPOINT_CACHE", str(tmp_path / "kept"))
    kernel, given = compile(both, q=2, v=(), M=(2, 3)), (np.zeros(2), 0.0, np.zeros((2, 3)))
    with monkeypatch.context() as broken:
        broken.setattr(StandInModule, "load", lambda self, compiled: 1 / 0)
        with pytest.raises(ZeroDivisionError):
            kernel.on_gpu()(*given)
    kernel.on_gpu()(*given)
    loads = iter([lambda self, compiled: 1 / 0, StandInModule.load])
    monkeypatch.setattr(StandInModule, "load", lambda self, compiled: next(loads)(self, compiled))
    kernel.on_gpu()(*given)
    assert len(stand_in.compiled) == 3


def test_without_cupy_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cupy", None)
    with pytest.raises(InputError, match=r'on_gpu needs CuPy: pip install "cutpoint\[cuda\]"'):
        compile(lambda x: x * 2, x=()).on_gpu()
