"""LLVM IR that makes Python's objects: where there is no memory for one, the call fails and leaves nothing behind."""

from cutpoint.kernels.machine.llvm_code import Code

DECLARATIONS = """declare ptr @PyArray_New(ptr, i32, ptr, i32, ptr, ptr, i32, i32, ptr)
declare ptr @PyArray_Scalar(ptr, ptr, ptr)
"""


def new(code: Code, expression: str, owner: str | None = None, k: int = 0) -> str:
    """What a call of the C API returns; the k-th of its owner, a tuple, if it has one."""
    made, failed = code.name("made"), code.name("failed")
    x = code.let(f"call ptr @{expression}")
    code.branch(code.let(f"icmp ne ptr {x}, null"), made, failed)
    code.open(failed)
    if owner:
        code.lines.append(f"call void @Py_DecRef(ptr {owner})")
    code.lines.append("ret ptr null")
    code.open(made)
    if owner:
        code.let(f"call i32 @PyTuple_SetItem(ptr {owner}, i64 {k}, ptr {x})")
    return x


def new_tuple(size: int) -> str:
    return f"PyTuple_New(i64 {size})"


def new_array(rank: int, shape: str, kind: int) -> str:
    """shape: a pointer to the lengths of its axes; kind: its type's number."""
    plain = "ptr null, ptr null, i32 0, i32 0, ptr null"
    return f"PyArray_New(ptr @array_type, i32 {rank}, ptr {shape}, i32 {kind}, {plain})"
