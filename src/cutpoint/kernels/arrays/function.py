"""A graph ready to run, on any backend."""

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np

Whole = Callable[[tuple[Any, ...], Any], Any]
"""whole(arguments, out): what a ufunc would return, None if it has to do the work: see `whole_batches`."""


class Element(Protocol):
    """A function that may have machine code for one element."""

    @property
    def element(self) -> int | None:
        """Its address, if there is any: see `cutpoint.kernels.machine.element`."""


class Function(Element, Protocol):
    """A graph ready to run."""

    call: Callable[..., Any]
    """call(*arrays, out=None) with the semantics of a NumPy generalised ufunc."""

    def whole(self, bound: Sequence[np.ndarray] = (), largest: float | None = None) -> Whole | None:
        """Makes `call` for whole batches, where that is supported: see `whole_batches`."""
