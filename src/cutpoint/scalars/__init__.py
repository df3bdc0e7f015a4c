"""Numbers of every kind, the functions on them, and records of them."""

from cutpoint.scalars.angle import Angle
from cutpoint.scalars.functions import (
    Scalar,
    absolute,
    acos,
    asin,
    atan,
    atan2,
    clip,
    cos,
    exp,
    is_plain_zero,
    known_truth,
    log,
    maximum,
    minimum,
    sin,
    sqrt,
    tan,
    tanh,
    where,
)
from cutpoint.scalars.jet import Jet, rate_of, value_of
from cutpoint.scalars.records import (
    constants,
    is_of_cutpoint,
    keys_of,
    leaves,
    map_leaves,
    named_parts,
    rebuild,
    structure_of,
    with_float_leaves,
)

__all__ = [
    "Angle", "Jet", "Scalar", "absolute", "acos", "asin", "atan", "atan2", "clip", "constants", "cos", "exp",
    "is_of_cutpoint", "is_plain_zero", "keys_of", "known_truth", "leaves", "log", "map_leaves", "maximum", "minimum",
    "named_parts", "rate_of", "rebuild", "sin", "sqrt", "structure_of", "tan", "tanh", "value_of", "where",
    "with_float_leaves",
]  # fmt: skip
