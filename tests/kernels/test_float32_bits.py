"""Single precision to the last bit: packs, blocks, threads, C, CUDA C and JAX agree with single calls."""

import math
import re
from collections import namedtuple
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jax
import numpy as np
import pytest
from cuda_builds import compiled
from emitters import EXACT, Rows, single
from graph_recipes import Step, cook_unbounded, unbounded_steps
from hypothesis import Phase, given, note, settings
from hypothesis import strategies as st
from single_precision import LONG, ROBOTS, TINY, batch, every_kind, robot_kernel, robot_rows

from c_builds import STRICT, assert_same_bits, build, run
from cutpoint.kernels import Kernel, compile
from cutpoint.kernels.arrays import packs, threads
from cutpoint.kernels.machine import strided_loop
from cutpoint.kernels.machine.batch_loop import WORTH_MAKING_PACKS
from cutpoint.kernels.machine.jit import vector_width
from cutpoint.scalars import atan, cos, exp, log, sin, tan, tanh, where

LARGEST = float(np.finfo(np.float32).max)
EDGES = [0.0, -0.0, TINY, 1e-40, 1e-30, 1e-8, 0.5, -1.0, 3.0, 1e5, 1e7, -1e30, LARGEST, np.inf, -np.inf, np.nan]
EXACT_32 = {name: emitter for name, emitter in EXACT.items() if not name.startswith("C99")}  # they build float64


def one_by_one(kernel: Kernel, rows: Rows) -> np.ndarray:
    return np.array([kernel(*row) for row in zip(*rows, strict=True)])


@pytest.mark.parametrize("size", [0, 1, 15, 16, 17, WORTH_MAKING_PACKS, LONG])
def test_every_way_through_a_batch_gives_the_bits_of_single_calls(size: int) -> None:
    kernel = compile(every_kind, q=7, v=(), M=(3, 4), backend="llvm").float32
    rows = batch(size)
    expected = one_by_one(kernel, rows).reshape(size, 3, 11)
    assert expected.dtype == np.float32 or not size
    wide = [np.repeat(x, 2, axis=-1)[..., ::2] if x.ndim > 1 else np.repeat(x, 2)[::2] for x in rows]
    for arguments in (rows, [*map(np.asfortranarray, rows)], wide, [x[::-1] for x in rows]):
        found = kernel(*arguments)
        same = expected[::-1] if arguments[0].strides[0] < 0 else expected
        assert found.dtype == np.float32 and np.array_equal(found, same)
    if size:
        blocks = kernel.blocks
        assert np.array_equal(blocks.rows(blocks(*map(blocks.of, rows)), size), expected)


def test_long_rows_run_in_packs_and_only_strided_elements_make_a_loop_for_them(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    for module, loop in (packs, "pack_loop"), (strided_loop, "strided_loop"):
        real = getattr(module, loop)
        monkeypatch.setattr(module, loop, lambda *given, real=real, loop=loop: made.append(loop) or real(*given))
    kernel, rows = compile(every_kind, q=7, v=(), M=(3, 4), backend="llvm").float32, batch(LONG)
    kernel(*rows)
    assert made == ["pack_loop"]
    kernel(*map(np.asfortranarray, rows))
    assert made == ["pack_loop", "strided_loop"]


@pytest.mark.parametrize("width", [2, 4, 8])
def test_every_width_of_packs_gives_the_bits_of_single_calls(width: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cutpoint.kernels.arrays.packs.vector_width", lambda: width)
    kernel, rows = compile(every_kind, q=7, v=(), M=(3, 4), backend="llvm").float32, batch(LONG)
    expected = one_by_one(kernel, rows)
    assert kernel.blocks.width == 2 * width
    assert np.array_equal(kernel(*rows), expected)
    assert np.array_equal(kernel(*map(np.asfortranarray, rows)), expected)


def test_blocks_hold_twice_as_many_as_in_double_precision() -> None:
    kernel = compile(lambda x: [sin(x[0]) * x[1]], x=2, backend="llvm")
    blocks = kernel.float32.blocks
    assert blocks.width == 2 * kernel.blocks.width == 2 * vector_width()
    made = blocks.of(np.ones((3, 2)))
    assert made.dtype == np.float32 and made.shape == (1, 2, blocks.width) and made.ctypes.data % 64 == 0
    assert blocks(np.ones((1, 2, 1))).dtype == np.float32


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_threads_share_a_batch(backend: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threads, "CHUNK", 1)
    kernel, rows = compile(every_kind, q=7, v=(), M=(3, 4), backend=backend).float32, batch(1003)
    found = kernel(*rows, threads=3)
    assert found.dtype == np.float32 and np.array_equal(found, kernel(*rows))


@pytest.mark.parametrize("emitter", EXACT_32)
@pytest.mark.parametrize(("robot", "function"), ROBOTS)
def test_emitters_give_the_bits_of_machine_code_for_robots(
    robot: str, function: str, emitter: str, tmp_path: Path
) -> None:
    kernel = robot_kernel(robot, function).float32
    rows = robot_rows(robot, kernel)
    for ours, theirs in zip(EXACT_32[emitter](kernel, tmp_path)(rows), single(kernel, tmp_path)(rows), strict=True):
        assert ours.dtype == np.float32
        assert_same_bits(ours, theirs)


Outputs = namedtuple("Outputs", "vector number")


@given(st.lists(st.lists(unbounded_steps, min_size=1, max_size=25), min_size=8, max_size=8), st.integers(0, 2**32 - 1))
@settings(max_examples=3, phases=(Phase.explicit, Phase.reuse, Phase.generate))
def test_emitters_give_the_bits_of_machine_code_for_random_expressions(
    tmp_path_factory: Any, recipes: list[list[Step]], seed: int
) -> None:
    def function(x: Any, k: Any) -> Outputs:
        found = [y for recipe in recipes for y in cook_unbounded(recipe, [*x, k])]
        return Outputs([*found, 0.1, x[0]], found[0])

    kernel, rng = compile(function, name="fuzzed", x=3, k=(), backend="llvm").float32, np.random.default_rng(seed)
    rows = [rng.choice(EDGES, (100, *shape)).astype(np.float32) for shape in ((3,), ())]
    expected = single(kernel, tmp_path_factory.mktemp("none"))(rows)
    for name, emitter in EXACT_32.items():
        note(name)
        for ours, theirs in zip(emitter(kernel, tmp_path_factory.mktemp("fuzzed"))(rows), expected, strict=True):
            assert_same_bits(ours, theirs)


def elementary(x: Any, k: Any) -> Any:
    found = [f(x[0] + k * x[1]) for f in (sin, cos, tan, exp, log, tanh, atan)]
    return [*found, x[0] * x[1] + 0.1, where(x[0] < k, x[2], -x[2] / k), math.inf, math.nan, -0.0]


def test_exported_c_gives_the_bits_of_machine_code(tmp_path: Path) -> None:
    compile(elementary, x=3, k=(), name="elementary", backend="llvm").float32.to_c(tmp_path)
    text = (tmp_path / "elementary.c").read_text()
    assert "double" not in re.sub(r"(?m)^#error.*", "", text)
    build(tmp_path, "-c", "elementary.c", flags=(*STRICT, "-Wdouble-promotion"))
    build(tmp_path, "elementary.c", "elementary_check.c", "-o", "check")
    code, told = run(tmp_path)
    assert (code, told) == (0, "elementary: 0 of 204 numbers differ\n")


def test_exported_cuda_compiles_without_a_double(tmp_path: Path) -> None:
    compile(elementary, x=3, k=(), name="elementary", backend="llvm").float32.to_cuda(tmp_path)
    text = (tmp_path / "elementary.cu").read_text()
    assembly, _ = compiled(text, "sm_90")
    assert "double" not in text and ".f64" not in assembly
    assert "rows of float32" in (tmp_path / "elementary.cuh").read_text()


@pytest.fixture(params=[True, False])
def jax_with_or_without_float64(request: pytest.FixtureRequest) -> Iterator[None]:
    jax.config.update("jax_enable_x64", request.param)
    yield
    jax.config.update("jax_enable_x64", True)


@pytest.mark.usefixtures("jax_with_or_without_float64")
def test_jax_takes_derivatives_in_single_precision() -> None:
    kernel = compile(lambda x: [sin(x[0]) * x[1], x[1] * x[1]], x=2, backend="llvm").float32
    function, x = kernel.to_jax(), np.array([0.5, -2.0], np.float32)
    assert_same_bits(function(x), kernel(x))
    found = jax.jacobian(function)(x)
    expected = [[math.cos(0.5) * -2, math.sin(0.5)], [0, -4]]
    assert function(x).dtype == found.dtype == np.float32
    np.testing.assert_allclose(found, expected, rtol=2.0**-21, atol=0)
