"""A kernel as a user calls it: its arguments are checked, and the robot's own inputs are added."""

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from cutpoint.door import LARGEST, are_plain_vectors, checked_array
from cutpoint.kernels import Kernel


class RobotFunction:
    """A kernel with validated arguments.

    sizes: of the users' inputs, by name.  added: the robot's own inputs after them.  record: holds the outputs.
    """

    def __init__(
        self,
        name: str,
        kernel: Kernel,
        sizes: Mapping[str, Any],
        added: Sequence[np.ndarray],
        record: type[tuple[Any, ...]] | None,
    ) -> None:
        self.name, self.kernel, self.sizes, self.added, self.record = name, kernel, sizes, added, record

    def __call__(self, *given: Any) -> Any:
        result = self._of_batch(given)
        if result is None:
            if not are_plain_vectors(given):  # the kernel itself refuses wrong lengths
                pairs = zip(self.sizes.items(), given, strict=True)
                given = tuple(checked_array(self.name, key, x, size) for (key, size), x in pairs)
            result = self.kernel.general(*given, *self.added)
        return self.record(*result) if self.record else result

    def _of_batch(self, given: tuple[Any, ...]) -> Any:
        """The outputs of a contiguous batch; None for everything else, including mistakes."""
        first = given[0] if given else None
        if type(first) is not np.ndarray or first.ndim < 2 or self._whole is None:
            return None
        found = self._whole(given, None)
        return (found,) if self.record and type(found) is np.ndarray else found

    def knows(self, parameters: np.ndarray) -> bool:
        """Whether these are the drives' parameters that it adds, or it adds none."""
        return not self.added or self.added[0] is parameters

    def bound_to(self, parameters: np.ndarray) -> "RobotFunction":
        """The same function for a robot whose drives have these parameters."""
        return RobotFunction(self.name, self.kernel, self.sizes, [parameters], self.record)

    def quick(self) -> Callable[..., Any]:
        """The same function in its fastest form for single calls."""
        return self.kernel.shortcut(self, bound=self.added, largest=LARGEST, record=self.record)

    @cached_property
    def _whole(self) -> Callable[..., Any] | None:
        return self.kernel.whole(bound=self.added, largest=LARGEST)
