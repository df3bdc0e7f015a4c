"""C99: the same bits as machine code, whatever compiler and flags; files that explain, check and guard themselves."""

import re
import subprocess
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from graph_recipes import choices_between_zeros, cook, every_turned_sign, signed_ones_and_zeros, steps
from hypothesis import given, settings
from hypothesis import strategies as st

import cutpoint
from c_builds import CFunction, assert_same_bits, build, compilers, cpp_compilers, pointer, run
from cutpoint import InputError
from cutpoint.kernels import compile
from cutpoint.kernels.graphs.nodes import CONDITIONS, PRIMITIVES

EDGES = [0.0, -0.0, 5e-324, 1e-300, 1e-8, 0.5, -1.0, 3.0, 1e5, 1e17, -1e300, np.inf, -np.inf, np.nan]
FLAGS = [
    ("-O0",),
    ("-O2",),
    ("-O3", "-march=native", "-fno-math-errno"),
    ("-std=gnu99", "-O2", "-march=native", "-ffp-contract=fast"),
]


def every_operation(x: Any, k: Any) -> Any:
    """All that a graph may hold, and both sides of each choice."""
    where = cutpoint.where
    choice = where(~(x[0] < x[1]) & (x[1] <= x[2]) | (x[2] < -3.25), x[0] / x[1], x[1] * x[2] - x[0])
    elementary = [f(x[0] + 0.1 * x[1]) for f in (cutpoint.sin, cutpoint.cos, cutpoint.tan, cutpoint.exp, cutpoint.log,
                                                 cutpoint.tanh, cutpoint.atan, cutpoint.sqrt)]  # fmt: skip
    return [choice, x[0] * x[1] + k, k - x[1] * x[2], x[0], 0.0, -2.5, float("inf"), float("nan"), *elementary]


@pytest.mark.parametrize("flags", FLAGS, ids=" ".join)
@pytest.mark.parametrize("compiler", compilers(), ids=lambda path: Path(path).name)
def test_every_operation_has_the_bits_of_machine_code(compiler: str, flags: tuple[str, ...], tmp_path: Path) -> None:
    kernel = compile(every_operation, x=3, k=(), backend="llvm")
    kernel.to_c(tmp_path)
    function = CFunction(tmp_path, "every_operation", kernel.graph, compiler, flags)
    rng = np.random.default_rng(1)
    cases = [rng.choice(EDGES, 3) for _ in range(300)] + [
        rng.normal(size=3) * 10.0 ** rng.integers(-3, 4) for _ in range(300)
    ]
    for x in cases:
        k = rng.choice(EDGES)
        assert_same_bits(function(x, k)[0], kernel(x, k))


@pytest.mark.parametrize("flags", FLAGS, ids=" ".join)
@pytest.mark.parametrize("compiler", compilers(), ids=lambda path: Path(path).name)
def test_exact_zeros_of_fused_operations_keep_their_sign(compiler: str, flags: tuple[str, ...], tmp_path: Path) -> None:
    kernel = compile(every_turned_sign, x=9, backend="llvm")
    kernel.to_c(tmp_path)
    function = CFunction(tmp_path, "every_turned_sign", kernel.graph, compiler, flags)
    zeros = 0
    for x in signed_ones_and_zeros(9):
        expected = kernel(x)
        zeros += np.count_nonzero(expected == 0)
        assert_same_bits(function(x)[0], expected)
    assert zeros > 100


@pytest.mark.parametrize("flags", [("-O1",), *FLAGS], ids=" ".join)
@pytest.mark.parametrize("compiler", compilers(), ids=lambda path: Path(path).name)
def test_choices_between_zeros_keep_their_sign(compiler: str, flags: tuple[str, ...], tmp_path: Path) -> None:
    kernel = compile(choices_between_zeros, x=2, backend="llvm")
    kernel.to_c(tmp_path)
    function = CFunction(tmp_path, "choices_between_zeros", kernel.graph, compiler, flags)
    for x in product([0.0, -0.0, 1.0, -1.0, np.nan, np.inf], repeat=2):
        assert_same_bits(function(np.array(x))[0], kernel(x))


@given(st.lists(st.lists(steps, min_size=1, max_size=25), min_size=20, max_size=20), st.integers(0, 2**32 - 1))
@settings(deadline=None, max_examples=4)
def test_random_expressions_have_the_bits_of_machine_code(tmp_path_factory: Any, recipes: Any, seed: int) -> None:
    folder, rng = tmp_path_factory.mktemp("random"), np.random.default_rng(seed)
    kernel = compile(lambda x: [y for recipe in recipes for y in cook(recipe, x)], name="anything", x=3, backend="llvm")
    kernel.to_c(folder)
    function = CFunction(folder, "anything", kernel.graph, flags=("-O1", "-march=native"))
    for x in [*rng.normal(size=(50, 3)), *rng.choice(EDGES, (50, 3)), *10 * rng.normal(size=(20, 3))]:
        assert_same_bits(function(x)[0], kernel(x))


def test_every_primitive_can_be_said_in_c() -> None:
    from cutpoint.kernels.targets import c99

    assert set(PRIMITIVES) == {"input", *c99._FORMS, *c99._HELPERS} and set(c99._FORMS) >= CONDITIONS


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    compile(lambda q, k: [cutpoint.sin(q[0]) * k, q[1] * q[0] + k], name="law", q=2, k=()).to_c(tmp_path)
    return tmp_path


@pytest.mark.parametrize("compiler", compilers(), ids=lambda path: Path(path).name)
def test_the_check_passes_and_fails_when_a_digit_is_changed(folder: Path, compiler: str) -> None:
    build(folder, "law.c", "law_check.c", "-o", "check", compiler=compiler)
    assert run(folder) == (0, "law: 0 of 34 numbers differ\n")
    text = (folder / "law.c").read_text()
    changed = text.replace("0x1.45f306dc9c883p-1", "0x1.45f306dc9c893p-1").replace("p-3", "p-2", 1)
    assert changed != text
    (folder / "law.c").write_text(changed)
    build(folder, "law.c", "law_check.c", "-o", "check", compiler=compiler)
    code, said = run(folder)
    assert code == 1 and re.search(r"case \d+: result\[0\] is -?0x\S+, recorded was -?0x", said)


def test_fast_math_is_refused(folder: Path) -> None:
    with pytest.raises(AssertionError, match="-ffast-math and parts of it change its results"):
        build(folder, "-c", "-ffast-math", "law.c")


def test_an_output_may_be_an_input(tmp_path: Path) -> None:
    kernel = compile(lambda x: [x[1], x[0], x[0] + x[1]], name="turn", x=3)
    kernel.to_c(tmp_path)
    function = CFunction(tmp_path, "turn", kernel.graph)
    x = np.array([1.0, 2.0, 4.0])
    function.call(pointer(x), pointer(x))
    assert x.tolist() == [2.0, 1.0, 3.0]


def test_code_calls_nothing_of_the_library_but_fma_and_sqrt(tmp_path: Path) -> None:
    compile(every_operation, x=3, k=()).to_c(tmp_path)
    code = (tmp_path / "every_operation.c").read_text().partition("FP_CONTRACT OFF")[2]
    called = set(re.findall(r"\b([a-z]\w*)\(", code)) - {"defined"}
    assert {c for c in called if not c.startswith("cutpoint_")} == {"fma", "sqrt", "memcpy", "every_operation"}


def test_unused_and_empty_arguments_compile(tmp_path: Path) -> None:
    kernel = compile(lambda a, b, c, d: ([1.5, b]), name="idle", a=4, b=(), c=0, d=())
    for own in (kernel, compile(lambda: 2.0, name="two")):
        folder = tmp_path / own.name
        own.to_c(folder)
        build(folder, f"{own.name}.c", f"{own.name}_check.c", "-o", "check")
        assert run(folder)[0] == 0


def test_the_same_kernel_gives_the_same_files(tmp_path: Path) -> None:
    for name in ("one", "two"):
        compile(every_operation, x=3, k=()).to_c(tmp_path / name)
    assert {p.name: p.read_bytes() for p in (tmp_path / "one").iterdir()} == {
        p.name: p.read_bytes() for p in (tmp_path / "two").iterdir()
    }


def test_only_our_own_files_are_overwritten_unless_forced(folder: Path) -> None:
    kernel = compile(lambda q: q * 2, name="law", q=())
    kernel.to_c(folder)
    (folder / "CMakeLists.txt").write_text("project(mine)\n")
    before = (folder / "law.c").read_text()
    with pytest.raises(InputError, match=r"CMakeLists.txt' was not written by cutpoint; .* or use force=True"):
        compile(lambda q: q * 3, name="law", q=()).to_c(folder)
    assert (folder / "law.c").read_text() == before and (folder / "CMakeLists.txt").read_text() == "project(mine)\n"
    assert kernel.to_c(folder, force=True)[0] == folder / "law.c"
    assert "project(law " in (folder / "CMakeLists.txt").read_text()


def test_a_link_is_a_file_of_somebody_elses_even_if_it_leads_nowhere(tmp_path: Path) -> None:
    (tmp_path / "package").mkdir()
    (tmp_path / "package" / "law.c").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(InputError, match=r"law.c' was not written by cutpoint"):
        compile(lambda q: q * 2, name="law", q=()).to_c(tmp_path / "package")
    assert not (tmp_path / "elsewhere").exists()


def test_a_folder_holds_one_function(folder: Path) -> None:
    """Its CMakeLists.txt would build the first no longer."""
    compile(lambda q: q * 2, name="law", q=()).to_c(folder)
    before = (folder / "CMakeLists.txt").read_text()
    other = compile(lambda q: q * 3, name="other", q=())
    with pytest.raises(InputError, match=r"CMakeLists.txt' builds 'law', but a package holds one function; choose"):
        other.to_c(folder)
    assert (folder / "CMakeLists.txt").read_text() == before and not (folder / "other.c").exists()
    other.to_c(folder, force=True)
    assert "project(other " in (folder / "CMakeLists.txt").read_text()


def test_a_package_is_replaced_whatever_text_somebody_has_added(folder: Path) -> None:
    kernel, path = compile(lambda q: q * 2, name="law", q=()), folder / "CMakeLists.txt"
    kernel.to_c(folder)
    before = path.read_bytes()
    path.write_bytes(before + "# Müller\n".encode("latin-1"))
    kernel.to_c(folder)
    assert path.read_bytes() == before


@pytest.mark.parametrize("force", [False, True])
def test_a_folder_that_no_files_can_be_written_to_is_refused(force: bool, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    kernel = compile(lambda q: q * 2, name="law", q=())
    for folder, told in ("file", "is not a folder"), ("file/law", "is not a folder"), ("x" * 300, "cannot be written"):
        for export in (kernel.to_c, kernel.to_cuda):
            with pytest.raises(InputError, match=rf"^folder '.*' {told}"):
                export(tmp_path / folder, force=force)


MACROS = ("NULL", "NAN", "INFINITY", "HUGE_VAL", "M_PI", "EOF", "I", "complex", "errno", "EINVAL", "INT_MAX", "PRIu64")
NAMES = [
    ("int", "x"),
    ("law", "template"),
    ("law", "q_ä"),
    ("law", "_1"),
    ("9", "x"),
    ("cutpoint_flip", "x"),
    ("ARM_STEP", "x"),
    ("law", "fma"),
    *((name, "x") for name in MACROS),
    *(("law", name) for name in MACROS),
]


@pytest.mark.parametrize(("name", "argument"), NAMES)
def test_names_that_c_cannot_take_are_refused(name: str, argument: str, tmp_path: Path) -> None:
    kernel = compile(lambda **given: given[argument] * 2, name=name, **{argument: ()})
    with pytest.raises(
        InputError,
        match=r"in C; it must start with a letter but not with 'cutpoint_', .*, as capitals with an underscore do",
    ):
        kernel.to_c(tmp_path)
    assert not [*tmp_path.iterdir()]


def test_what_gives_no_numbers_is_not_exported(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"^nothing: it returns no numbers"):
        compile(lambda x: [], name="nothing", x=2).to_c(tmp_path)
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize("force", [False, True])
def test_a_folder_is_a_path(force: bool) -> None:
    kernel = compile(lambda q: q * 2, name="law", q=())
    for export in (kernel.to_c, kernel.to_cuda):
        with pytest.raises(InputError, match=r"^folder must be a path, got 3"):
            export(3, force=force)  # type: ignore[arg-type]


OF_THE_LIBRARY = [
    "sin", "sinf", "fmal", "main", "memcpy", "y0", "exp", "log", "pow", "hypot", "round", "floor", "copysign", "gamma",
    "div", "abs", "system", "random", "cabs", "isnan", "strcmp", "fopen", "snprintf", "clock", "size_t", "test", "std",
    "m", "debug", "general", "requires", "co_await", "linux", "st_atime", "si_pid", "ALIAS", "COMMAND", "INTERFACE",
    "preinstall", "initstate", "setstate",
]  # fmt: skip


@pytest.mark.parametrize("name", OF_THE_LIBRARY)
def test_a_function_is_not_called_as_one_of_cs_library_is(name: str, tmp_path: Path) -> None:
    kernel = compile(lambda x: x * 2, name=name, x=())
    with pytest.raises(InputError, match=r"already uses this name: rename it|look like a keyword or macro of C"):
        kernel.to_c(tmp_path)
    assert not [*tmp_path.iterdir()]


USED_WITHIN = [("expected", "T0"), ("names", "found"), ("i", "inputs"), ("x", "std"), ("T", "exp"), ("address", "k")]


@pytest.mark.parametrize(("name", "argument"), USED_WITHIN)
def test_names_may_be_those_that_the_files_use_themselves(name: str, argument: str, tmp_path: Path) -> None:
    compile(lambda **given: [given[argument][0] * 2], name=name, backend="llvm", **{argument: 2}).to_c(tmp_path)
    build(tmp_path, f"{name}.c", f"{name}_check.c", "-o", "check")
    assert run(tmp_path)[0] == 0
    text = f'#include "{name}.hpp"\n#include <array>\n#include <cmath>\n#include <cstdlib>\n'
    parameters = "std::array<double, 2> in, std::array<double, 1> out"
    (tmp_path / "use.cpp").write_text(f"{text}void use({parameters}) {{ cutpoint::{name}(in, out); }}\n")
    for compiler in cpp_compilers():
        build(tmp_path, "-shared", "-fPIC", "use.cpp", compiler=compiler, flags=("-std=c++17", "-Wall", "-Werror"))


WRONG_CONTAINERS = {
    "std::array<double, 3> in;": "of another size",
    "std::array<double, 1> in;": "of another size",
    "struct { enum { SizeAtCompileTime = 2, InnerStrideAtCompileTime = 6 }; double *data() { return nullptr; }"
    " int size() { return 2; } } in;": "one after another",
}  # fmt: skip


@pytest.mark.parametrize("container", WRONG_CONTAINERS)
def test_containers_that_do_not_fit_are_refused_by_the_compiler(container: str, tmp_path: Path) -> None:
    compile(lambda x: [x[0] * x[1]], name="law", x=2).to_c(tmp_path)
    use = f"void use() {{ {container} std::array<double, 1> out; cutpoint::law(in, out); }}\n"
    (tmp_path / "use.cpp").write_text(f'#include "law.hpp"\n#include <array>\n{use}')
    for compiler in cpp_compilers():
        found = subprocess.run([compiler, "-std=c++17", "-DNDEBUG", "-c", "use.cpp"], cwd=tmp_path, capture_output=True)
        assert found.returncode and WRONG_CONTAINERS[container] in found.stderr.decode()


def test_two_arguments_of_one_name_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="'result' names two things"):
        compile(lambda result: result * 2, name="law", result=()).to_c(tmp_path)
