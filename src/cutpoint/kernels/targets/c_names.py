"""Names that functions and arguments can have in C and C++, whatever headers of their libraries a program includes.

Those of POSIX have more macros: B0 of termios.h, for one.
"""

import re
from collections.abc import Sequence

from cutpoint.errors import InputError
from cutpoint.kernels.graphs.ports import Port

_RESERVED = frozenset({
    "alignas", "alignof", "and", "and_eq", "asm", "auto", "bitand", "bitor", "bool", "break", "case", "catch", "char",
    "class", "compl", "const", "const_cast", "constexpr", "continue", "decltype", "default", "delete", "do", "double",
    "dynamic_cast", "else", "enum", "explicit", "export", "extern", "false", "float", "for", "friend", "goto", "if",
    "inline", "int", "long", "mutable", "namespace", "new", "noexcept", "not", "not_eq", "nullptr", "operator", "or",
    "or_eq", "private", "protected", "public", "register", "reinterpret_cast", "restrict", "return", "short",
    "signed", "sizeof", "static", "static_assert", "static_cast", "struct", "switch", "template", "this",
    "thread_local", "throw", "true", "try", "typedef", "typeid", "typename", "union", "unsigned", "using", "virtual",
    "void", "volatile", "wchar_t", "while", "xor", "xor_eq", "fma", "fmaf", "sqrt", "sqrtf", "memcpy", "uint32_t",
    "uint64_t", "char8_t", "char16_t", "char32_t", "co_await", "co_return", "co_yield", "concept", "consteval",
    "constinit", "requires", "typeof", "typeof_unqual",
})  # fmt: skip
"""Words of C and C++, and what the code calls."""

_MACROS = re.compile(
    "NULL|NAN|INFINITY|HUGE(_VAL.*)?|EOF|BUFSIZ|FILE|I|complex|imaginary|assert|errno|offsetof|std(in|out|err)"
    "|signgam|math_errhandling|E[A-Z0-9]{2,}|M_(E|PI|LN|LOG|SQRT|[12]_).*|[A-Z][A-Z0-9]+_[A-Z0-9_]+|(PRI|SCN)[a-zX].*"
    "|SNAN.*|SIG(?!MA)[A-Z0-9]+|NSIG|WEOF|MAXFLOAT|[FRWX]_OK|F_T?U?LOCK|[LP]_tmp(nam|dir)"
    "|linux|unix|st_[acm]time|s[ai]_[a-z]+|h_addr"
)
"""What a header may have put something else for: constants, error numbers, formats."""

_LIBRARY = re.compile(
    # mathematics for every type, and for complex numbers
    "(c?(abs|a?(cos|sin|tan)(h|pi)?|exp|log|log10|pow|sqrt)|c(arg|imag|onj|proj|real)"
    "|atan2(pi)?|cbrt|ceil|copysign|drem|erfc?|exp(2|10|m1)|f(abs|dim|ma|mod)|f(max|min)(imum)?(_?mag)?(_num)?|finite|floor"
    "|frexp|hypot|i?logb|llogb|is(finite|inf|nan)|[jy][01n]|ldexp|[lt]?gamma(_r)?|log(1p|2)|l?l?(rint|round)|modf|nan"
    "|rsqrt|nearbyint|next(after|toward|up|down)|remainder|remquo|roundeven|scalb(l?n)?|significand|sincos|trunc"
    "|canonicalize|u?fromfpx?|[gs]etpayload(sig)?|totalorder(mag)?)(f|l|f(16|32|64|128)x?)?"
    # for two types, and for any
    "|(f|d|f(32|64)x?)(add|sub|mul|div|fma|sqrt)(l|f(32|64|128)x?)?|fpclassify|signbit|is(normal|unordered)"
    "|is(greater|less)(equal|greater)?|fe(get|set|clear|raise|test|hold|update)[a-z]+"
    # files
    "|.*(printf|scanf)|f?(get|put)(s|w?c(har)?|w|ws)|unget(c|wc)|.*_unlocked|f(get|set)pos(64)?|(f|fd|p|fre)?open(64)?"
    "|[fp]?close(all)?|f?(read|write)|f?(flush|seek|tell)o?(64)?|tmp(file|nam)(64)?|set(v|line)?buf(fer)?|mk.?.?temps?"
    "|clearerr|feof|ferror|fileno|getline|perror|remove|rename|rewind"
    # numbers and memory
    "|l?l?(abs|div)|imax(abs|div)|ato(f|ll?|i)|(c|m|re|v|aligned_)alloc|reallocarray|free|b(cmp|copy|zero)|bsearch|q?sort"
    "|(s?rand(om)?|(init|set)state)(_r)?|[dejlmns](rand|eed|cong)48(_r)?|arc4random.*|q?[efg]cvt"
    "|w?mem(c?cpy|pcpy|move|set|cmp|chr)"
    # characters and strings
    "|is(al(num|pha)|ascii|blank|cntrl|x?digit|graph|lower|print|punct|space|upper)|to(w?lower|w?upper|ascii)|isw[a-z]+"
    "|mb(len|r?towc|s?r?towcs)|wcr?tomb|wcs.+|stpn?cpy|ffsl?l?|r?index|str(to|from).*|str[fp]time|localeconv|setlocale"
    "|str(n?cat|n?cmp|n?cpy|n?dupa?|r?chr|n?len|c?spn|pbrk|str|tok|coll|xfrm|n?casecmp|error|fry|sep|signal)"
    # time and processes
    "|(asc|c|gm|mk|local|diff)?time|time(gm|local|s|zone|spec_get)|clock(_[gs]et.*)?|timer_.*|(u|nano)?sleep|tz(name|set)"
    "|(at_?|on_)?(quick_)?_?exit|abort|(get|set|put|unset|clear)env|getdate|daylight|(set|long)jmp|dup[23]?|v?fork"
    "|exec(l|v)?p?e?|accept|access|alarm|bind|connect|environ|ioctl|kill|link|listen|main|nice|pause|pipe|poll|raise"
    "|realpath|recv|select|send|shutdown|signal|socket|stat|sync|system|truncate|unlink|wait"
    # types, namespaces, and what CMake takes for a target or a kind of build
    "|.*_t|va_list|u_?(int|long|short|char)|std|Eigen|cutpoint"
    "|m|all|clean|edit_cache|help|(pre)?install|package|rebuild_cache|test|debug|optimized|general|ALIAS|COMMAND|EXPORT"
    "|IMPORTED|INTERFACE|MODULE|OBJECT|PRIVATE|PUBLIC|SHARED|STATIC|TARGETS|UNKNOWN"
)
"""Names that the library has already, of which a compiler or a linker would take ours for one."""


def check_names(function: str, inputs: Sequence[Port], outputs: Sequence[Port]) -> None:
    """Raises InputError for a name that is invalid in C or C++, or that two arguments share."""
    names = [function, *(p.name for p in (*inputs, *outputs))]
    for name in names:
        is_one = re.fullmatch("(?!cutpoint_)[A-Za-z][A-Za-z0-9_]{0,127}", name)
        if not is_one or name in _RESERVED or _MACROS.fullmatch(name):
            kinds = "at most 128 ASCII letters, digits and underscores"
            looks = "look like a keyword or macro of C, as capitals with an underscore do"
            rule = f"must start with a letter but not with 'cutpoint_', hold {kinds}, and not {looks}"
            raise InputError(f"{function}: {name!r} cannot be a name in C; it {rule}: rename it", name=name)
    if _LIBRARY.fullmatch(function):
        owner = "C's own library, its build or Eigen"
        raise InputError(f"{function}: {owner} already uses this name: rename it", name=function)
    twice = [name for name in names[1:] if names.count(name) > 1]
    if twice:
        raise InputError(f"{function}: {twice[0]!r} names two things; in C each needs its own name", name=twice[0])
