"""Error messages for wrong arguments in calling or compiling a kernel."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest

from cutpoint.errors import CutpointError, InputError, TraceError
from cutpoint.kernels import Kernel, compile, jacobian_of
from cutpoint.kernels.arrays import backends

BACKENDS = ("llvm", "numpy")
ZEROS = np.zeros((4, 6))


@pytest.fixture(params=BACKENDS)
def kernel(request: pytest.FixtureRequest) -> Kernel:
    def inverse_dynamics(q: Any, v: Any, T: Any) -> Any:
        return [x * v + T[0][0] for x in q]

    return compile(inverse_dynamics, q=6, v=(), T=(2, 3), backend=request.param)


T = np.zeros((2, 3))
CALLS: list[tuple[Callable[[Kernel], Any], str]] = [
    (lambda k: k(np.zeros(5), 0, T), "inverse_dynamics: q has shape (5,): its last axis must be 6"),
    (lambda k: k(1.0, 0, T), "inverse_dynamics: q has shape (): its last axis must be 6"),
    (lambda k: k(np.zeros((6, 1)), 0, T), "q has shape (6, 1): its last axis must be 6"),
    (lambda k: k(ZEROS, 0, T.T), "T has shape (3, 2): its last axes must be (2, 3)"),
    (lambda k: k(ZEROS, np.zeros(3), T), "leading axes do not broadcast: q (4,), v (3,), T ()"),
    (lambda k: k(ZEROS, 0), "T missing; it takes q, v, T"),
    (lambda k: k(ZEROS, 0, T, T), "4 arguments given, but it takes 3: q, v, T"),
    (lambda k: k(ZEROS, 0, T=T, w=0), "no input of inverse_dynamics is named 'w'; there are: 'q', 'v', 'T'"),
    (lambda k: k(ZEROS, 0, T=T, q=ZEROS), "q is given twice"),
    (lambda k: k(ZEROS * 1j, 0, T), "q holds complex128"),
    (lambda k: k(["a"] * 6, 0, T), "q holds <U1"),
    (lambda k: k([None] * 6, 0, T), "q holds NoneType"),
    (lambda k: k([[1, 2], [3]], 0, T), "q is not an array"),
    (lambda k: k([2**70, 1, 1, 1, 1, 1], 0, T), "q holds Python objects (int), not floats"),
    (lambda k: k(ZEROS, 0, T, out=ZEROS[:, 1:]), "result has shape (4, 5), but must be an array of shape (4, 6)"),
    (lambda k: k(ZEROS, 0, T, out=(ZEROS, ZEROS)), "out holds 2 arrays, but must hold 1: result"),
    (lambda k: k(ZEROS, 0, T, out=[0]), "out for result is a list"),
    (lambda k: k(ZEROS, 0, T, out=np.zeros((4, 6), int)), "out for result is of int64, but must be of floats"),
]  # fmt: skip


@pytest.mark.parametrize("case", range(len(CALLS)))
def test_no_wrong_argument_reaches_machine_code(kernel: Kernel, case: int) -> None:
    call, message = CALLS[case]
    with pytest.raises(InputError) as caught:
        call(kernel)
    assert message in str(caught.value) and str(caught.value).startswith(("inverse_dynamics: ", "no input"))


def test_a_kernel_cannot_be_traced(kernel: Kernel) -> None:
    with pytest.raises(InputError, match="call the function that it was made from"):
        compile(lambda x: kernel([x] * 6, x, [[x] * 3] * 2), x=())


MANY: dict[str, Any] = {f"x{k}": () for k in range(70)}


def total(**numbers: Any) -> Any:
    return sum(numbers.values())


DEFINITIONS: list[tuple[Callable[[], Any], type[CutpointError], str]] = [
    (lambda: compile(lambda x: x, x=-1), InputError, "input 'x': shape -1 must be"),
    (lambda: compile(lambda x: x, x=(2, -1)), InputError, "shape (2, -1)"),
    (lambda: compile(lambda x: x, x=2.5), InputError, "shape 2.5"),  # type: ignore[arg-type]
    (lambda: compile(lambda x: x, x=1, name=2), InputError, "name=2 must be a string"),
    (lambda: compile(lambda x, out: x, x=1, out=1), InputError, "have their own out=; rename the input"),
    (lambda: compile(lambda x: x, y=1), InputError, "its parameters are not the inputs ['y']"),
    (lambda: compile(lambda q: q), InputError, "give each parameter's shape by its name, as in compile(function, q=6"),
    (lambda: compile(lambda x: x, x=1, backend="fortran"), InputError, "no backend is named 'fortran'"),
    (lambda: compile(lambda x: [x, [x]], x=()), TraceError, "'result' is ragged"),
    (lambda: compile(lambda x: x, x=100_000, backend="llvm"), InputError, "use backend='numpy'"),
    (lambda: compile(total, **MANY, backend="llvm"), InputError, "71 inputs and outputs, at most"),
    (lambda: compile(max, x=()), InputError, "max: its parameters are not known; compile lambda x: max(...)"),
    (lambda: compile(lambda x: x * 10**400, x=()), TraceError, "at most 1.8e+308; this int is larger"),
    (lambda: compile(lambda x: [x, 10**400], x=()), TraceError, "at most 1.8e+308; this int is larger"),
    (
        lambda: compile(jacobian_of(total, with_respect_to=[]), x=()),
        InputError,
        "names no input; leave out the argument",
    ),
    (lambda: compile(jacobian_of(total, of=[]), x=()), InputError, "leave out the argument for all of them: result"),
]


@pytest.mark.parametrize("case", range(len(DEFINITIONS)))
def test_definitions_that_make_no_sense_are_explained(case: int) -> None:
    define, kind, message = DEFINITIONS[case]
    with pytest.raises(kind) as caught:
        define()
    assert message in str(caught.value)


def test_numpy_takes_more_arguments_than_machine_code() -> None:
    assert compile(total, **MANY, backend="numpy")(*range(70)) == sum(range(70))


@pytest.mark.parametrize("empty", [False, True])
@pytest.mark.parametrize("backend", BACKENDS)
def test_arrays_for_several_outputs_are_a_tuple(backend: str, empty: bool) -> None:
    """An output of size 0 takes another way."""

    class Two(NamedTuple):
        first: Any
        second: Any

    kernel = compile(lambda x: Two(x, [] if empty else [x]), name="two", x=(), backend=backend)
    arrays = [np.empty(4), np.empty((4, 0 if empty else 1))]
    assert kernel(np.arange(4.0), out=(*arrays,)).second is arrays[1]
    with pytest.raises(InputError, match=r"two: out is a list, but must be a tuple of 2 arrays: first, second"):
        kernel(np.arange(4.0), out=arrays)
    with pytest.raises(InputError, match=r"out for second is a list, but must be an array of shape"):
        kernel(np.arange(4.0), out=(arrays[0], []))


def test_a_missing_llvm_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(backends, "llvm_is_installed", lambda: False)
    with pytest.raises(InputError, match="pip install llvmlite"):
        compile(lambda x: x, x=(), backend="llvm")


def test_numbers_that_a_kernel_would_shorten_are_named() -> None:
    half = compile(lambda x: x / 2, name="half", x=(), backend="llvm")
    with pytest.raises(InputError, match=r"half: x holds float\d+, more precise than float64; pass np.asarray"):
        half(np.longdouble(1))


@pytest.mark.parametrize("names", ["theta", 3, [["theta"]]])
def test_names_of_derivatives_are_a_list(names: Any) -> None:
    for what in ("of", "with_respect_to"):
        with pytest.raises(InputError, match=f"jacobian_of: {what} must be a list of names, got"):
            jacobian_of(lambda theta: theta, **{what: names})
    with pytest.raises(InputError, match="function must be a function, got None"):
        jacobian_of(None)  # type: ignore[arg-type]
