"""LLVM IR that recognises plain arguments of a Python call: a chain of tests that exits at the first failure."""

from collections.abc import Callable, Sequence

import numpy as np

from cutpoint.errors import InputError
from cutpoint.kernels.arrays import numpy_api, python_api
from cutpoint.kernels.arrays.numpy_api import DATA, FLAGS, RANK, SHAPE, TIDY, TYPE
from cutpoint.kernels.arrays.python_api import KIND, VALUE
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.machine.jit import vector_width
from cutpoint.kernels.machine.llvm_code import Code, literal

ELSEWHERE = "%general"
"""Where calls go whose arguments are not plain."""


def is_possible() -> bool:
    """Whether Python's and NumPy's objects are as machine code assumes."""
    return python_api.objects_are_as_expected() and numpy_api.arrays_are_as_expected()


def check_bound(name: str, ports: Sequence[Port], bound: Sequence[np.ndarray]) -> None:
    """Raises InputError if machine code cannot read an array for one of a kernel's last inputs."""
    for port, x in zip(ports[len(ports) - len(bound) :], bound, strict=True):
        if x.shape != port.shape or x.dtype != np.float64 or not (x.flags.c_contiguous and x.flags.aligned):
            raise InputError(f"{name}: what is bound to {port.name} must be a tidy float64 array of shape {port.shape}")


def recognised(code: Code, ports: Sequence[Port], largest: float | None) -> list[str]:
    """Pointers to the arguments' numbers; branches to ELSEWHERE for anything unrecognised."""
    require(code, code.let(f"icmp eq i64 %count, {len(ports)}"), code.let("icmp eq ptr %names, null"))
    objects = [code.load("%arguments", k, "ptr") for k in range(len(ports))]
    found = [(plain_array if p.shape else _scalar)(code, x, p) for x, p in zip(objects, ports, strict=True)]
    if largest is not None:
        _require_within(code, [(pointer, port.size) for pointer, port in zip(found, ports, strict=True)], largest)
    return found


def plain_array(code: Code, x: str, port: Port) -> str:
    """A pointer to the numbers of an object, if it is a contiguous float64 array of the port's shape."""
    require_array(code, x, "float64", TIDY)
    require(code, code.let(f"icmp eq i32 {code.field(x, RANK, 'i32')}, {len(port.shape)}"))
    if port.shape:
        shape = code.field(x, SHAPE)
        require(code, *(code.let(f"icmp eq i64 {code.load(shape, k, 'i64')}, {n}") for k, n in enumerate(port.shape)))
    return code.field(x, DATA)


def require_array(code: Code, x: str, dtype: str, flags: int) -> None:
    """Requires an object to be an array of this type with these flags."""
    require(code, code.let(f"icmp eq ptr {code.field(x, KIND)}, @array_type"))
    found = code.let(f"and i32 {code.field(x, FLAGS, 'i32')}, {flags}")
    of_type = code.let(f"icmp eq ptr {code.field(x, TYPE)}, @{dtype}")
    require(code, of_type, code.let(f"icmp eq i32 {found}, {flags}"))


def _scalar(code: Code, x: str, port: Port) -> str:
    """A pointer to a number, or to that of a zero-dimensional array."""
    (pointer,) = number_or_array(code, x, ["ptr"], [], lambda: [plain_array(code, x, port)])
    return pointer


def number_or_array(
    code: Code, x: str, kinds: Sequence[str], with_number: Sequence[str], of_array: Callable[[], Sequence[str]]
) -> list[str]:
    """For a float, or an np.float64, which stores its value at the same offset: a pointer to it, and `with_number`.

    For any other object the result of `of_array`.  kinds: the LLVM types of these values.
    """
    number, other, array, end = (code.name(x) for x in ("number", "other", "array", "end"))
    value, kind = code.at(x, VALUE, "i8"), code.field(x, KIND)
    are = [code.let(f"icmp eq ptr {kind}, @{name}") for name in ("float_type", "float64_type")]
    code.label(number)
    code.branch(code.let(f"or i1 {', '.join(are)}"), end, other)
    code.open(other)
    found = of_array()
    code.label(array)
    code.label(end)
    pairs = zip(kinds, (value, *with_number), found, strict=True)
    return [code.let(f"phi {kind} [ {a}, {number} ], [ {b}, {array} ]") for kind, a, b in pairs]


def _require_within(code: Code, arguments: list[tuple[str, int]], largest: float) -> None:
    width, conditions = vector_width(), []
    for pointer, size in arguments:
        if size >= width:
            with code.loop(size // width) as loop:
                block = code.at(pointer, code.let(f"mul i64 {loop.iteration}, {width}"))
                require(code, are_within(code, block, width, largest))
        if size % width:
            conditions.append(are_within(code, code.at(pointer, size // width * width), size % width, largest))
    if conditions:
        require(code, *conditions)


def are_within(code: Code, pointer: str, size: int, largest: float) -> str:
    """Whether all are within the limit, by squares: greater, or unordered, for numbers beyond it, infinite or NaN."""
    kind = f"<{size} x double>"
    x = code.load(pointer, 0, kind, align=8)
    square = code.let(f"fmul {kind} {x}, {x}")
    odd = code.let(f"fcmp ugt {kind} {square}, {splat(largest * largest, size)}")
    return code.let(f"icmp eq i{size} {code.let(f'bitcast <{size} x i1> {odd} to i{size}')}, 0")


def splat(x: float, size: int) -> str:
    """A constant in every lane of a vector."""
    return f"<{', '.join([f'double {literal(x)}'] * size)}>"


def require(code: Code, *conditions: str, otherwise: str = ELSEWHERE) -> None:
    """Branches elsewhere unless all conditions hold."""
    all_hold, then = conditions[0], code.name("then")
    for condition in conditions[1:]:
        all_hold = code.let(f"and i1 {all_hold}, {condition}")
    code.branch(all_hold, then, otherwise)
    code.open(then)
