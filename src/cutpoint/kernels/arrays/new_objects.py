"""LLVM IR that makes Python's objects: where there is no memory for one, the call fails and leaves nothing behind."""

from cutpoint.kernels.machine.llvm_code import Code


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
