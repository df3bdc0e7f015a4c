"""Names that functions and their arguments can have in C and C++."""

import re
from collections.abc import Sequence

from cutpoint.errors import InputError
from cutpoint.kernels.ports import Port

_RESERVED = frozenset({
    "alignas", "alignof", "and", "and_eq", "asm", "auto", "bitand", "bitor", "bool", "break", "case", "catch", "char",
    "class", "compl", "const", "const_cast", "constexpr", "continue", "decltype", "default", "delete", "do", "double",
    "dynamic_cast", "else", "enum", "explicit", "export", "extern", "false", "float", "for", "friend", "goto", "if",
    "inline", "int", "long", "mutable", "namespace", "new", "noexcept", "not", "not_eq", "nullptr", "operator", "or",
    "or_eq", "private", "protected", "public", "register", "reinterpret_cast", "restrict", "return", "short",
    "signed", "sizeof", "static", "static_assert", "static_cast", "struct", "switch", "template", "this",
    "thread_local", "throw", "true", "try", "typedef", "typeid", "typename", "union", "unsigned", "using", "virtual",
    "void", "volatile", "wchar_t", "while", "xor", "xor_eq", "fma", "fmaf", "sqrt", "sqrtf", "memcpy", "uint32_t",
    "uint64_t",
})  # fmt: skip
"""Words of C and C++, and what the code calls."""

_LIBRARY = frozenset({
    "abort", "abs", "acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "calloc", "cbrt", "ceil", "copysign",
    "cos", "cosh", "div", "erf", "erfc", "exit", "exp", "exp2", "expm1", "fabs", "fdim", "floor", "fma", "fmax", "fmin",
    "fmod", "free", "frexp", "gamma", "hypot", "ilogb", "index", "j0", "j1", "jn", "labs", "ldexp", "lgamma", "llabs",
    "llrint", "llround", "log", "log10", "log1p", "log2", "logb", "lrint", "lround", "main", "malloc", "memcmp",
    "memcpy", "memmove", "memset", "modf", "nan", "nearbyint", "nextafter", "nexttoward", "pow", "printf", "puts",
    "rand", "realloc", "remainder", "remquo", "rint", "round", "scalbln", "scalbn", "signal", "sin", "sinh", "sqrt",
    "strlen", "tan", "tanh", "tgamma", "time", "trunc", "y0", "y1", "yn",
})  # fmt: skip
"""Functions of C's library, of which a linker or a compiler would take ours for one; many also end in f and l."""


def check_names(function: str, inputs: Sequence[Port], outputs: Sequence[Port]) -> None:
    """Raises InputError for a name that C or C++ cannot take, or that two arguments share."""
    names = [function, *(p.name for p in (*inputs, *outputs))]
    for name in names:
        if not re.fullmatch("(?!cutpoint_)[A-Za-z][A-Za-z0-9_]*", name) or name in _RESERVED:
            rule = "must start with a letter, hold ASCII letters, digits and underscores, and be no word of C or C++"
            raise InputError(f"{function}: {name!r} cannot be a name in C; it {rule}: rename it", name=name)
    if re.sub("[fl]$", "", function) in _LIBRARY or function in _LIBRARY:
        raise InputError(f"{function}: C's own library has a function of this name: rename it", name=function)
    twice = [name for name in names[1:] if names.count(name) > 1]
    if twice:
        raise InputError(
            f"{function}: {twice[0]!r} names two things; in C each must have a name of its own", name=twice[0]
        )
