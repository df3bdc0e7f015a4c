"""Inputs and outputs of size 0, which NumPy's generalised ufuncs and machine code do not handle."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from cutpoint.kernels.arrays.arguments import as_numbers, batch_shape
from cutpoint.kernels.graphs.ports import Port
from cutpoint.kernels.graphs.precision import Precision


def around_empty_ports(
    ufunc: Callable[..., Any], precision: Precision, inputs: Sequence[Port], outputs: Sequence[Port]
) -> Callable[..., Any]:
    """A ufunc of the ports of nonzero size, as one of all ports."""
    if all(port.size for port in (*inputs, *outputs)):
        return ufunc

    def call(*arguments: Any, out: Any = None) -> Any:
        pairs = [(p, as_numbers(a, precision)) for p, a in zip(inputs, arguments, strict=True)]
        batch = np.broadcast_shapes(*(batch_shape(p, a) for p, a in pairs))
        targets = _targets(precision, outputs, batch, out)
        (port, first), *others = [(p, a) for p, a in pairs if p.size]
        # the batch's axes may come from an empty input alone
        given = [np.broadcast_to(first, (*batch, *port.shape)), *(a for _, a in others)]
        ufunc(*given, out=tuple(t for p, t in zip(outputs, targets, strict=True) if p.size))
        results = targets if out is not None else [t if t.ndim else t[()] for t in targets]
        return results[0] if len(results) == 1 else tuple(results)

    return call


def _targets(precision: Precision, outputs: Sequence[Port], batch: tuple[int, ...], out: Any) -> list[np.ndarray]:
    """Arrays for the results."""
    if out is None:
        return [np.empty((*batch, *p.shape), precision.dtype) for p in outputs]
    targets = [*out] if isinstance(out, tuple) else [out]
    for port, target in zip(outputs, targets, strict=True):
        if not isinstance(target, np.ndarray):
            raise TypeError("out must be arrays")
        batch_shape(port, target)
    return targets
