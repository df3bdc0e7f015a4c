"""A graph ready to run, whatever runs it."""

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np

Whole = Callable[[tuple[Any, ...], Any], Any]
"""whole(arguments, out): what a ufunc would return, None if it has to do the work: see `whole_batches`."""


class Element(Protocol):
    """What may have machine code for one element."""

    @property
    def element(self) -> int | None:
        """Where it is, if there is some: see `cutpoint.kernels.machine.element`."""


class Function(Element, Protocol):
    """A graph ready to run."""

    call: Callable[..., Any]
    """call(*arrays, out=None) with the semantics of a NumPy generalised ufunc."""

    def whole(self, bound: Sequence[np.ndarray] = (), largest: float | None = None) -> Whole | None:
        """Makes `call` for batches given whole, where there is such a way: see `whole_batches`."""
