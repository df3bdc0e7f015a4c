"""LLVM IR of a loop in the calling convention of NumPy's generalised ufuncs."""

from cutpoint.kernels.machine.llvm_code import Code

_ALL_EXCEPTIONS = 0x3F
"""A superset of every platform's FE_ALL_EXCEPT."""


def ufunc_loop(name: str, code: Code, attributes: str = "") -> str:
    """Text of void name(char **arguments, i64 *dimensions, i64 *steps, void *data), and of `bare(name)`.

    The code reads %arguments, %dimensions, %steps and %data.
    """
    parameters = "ptr %arguments, ptr %dimensions, ptr %steps, ptr %data"
    lines = [f"define void @{bare(name)}({parameters}) {attributes} {{\nentry:", *code.lines, "ret void", "}"]
    lines += ["declare i32 @feclearexcept(i32)", f"define void @{name}({parameters}) {{\nentry:"]
    lines.append(f"call void @{bare(name)}({parameters})")
    # results, not processor flags, show overflow and NaN: both operands of a select are computed
    return "\n".join([*lines, f"call i32 @feclearexcept(i32 {_ALL_EXCEPTIONS})", "ret void", "}", ""])


def bare(name: str) -> str:
    """The same loop without clearing the processor's flags, which takes as long as a small batch."""
    return f"{name}_bare"
