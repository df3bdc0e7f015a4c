"""A kernel as a user calls it: what is given is checked, what the robot knows is added."""

from collections.abc import Callable
from typing import Any, NamedTuple

from cutpoint.door import LARGEST, are_plain_vectors, checked_array
from cutpoint.kernels import Kernel


class RobotFunction(NamedTuple):
    """A kernel behind the door: the inputs that users give with their sizes, and what the robot adds."""

    name: str
    kernel: Kernel
    sizes: dict[str, Any]
    added: list[Any]
    record: type[tuple[Any, ...]] | None

    def __call__(self, *given: Any) -> Any:
        if not are_plain_vectors(given):  # of the wrong length they are the kernel's to refuse
            pairs = zip(self.sizes.items(), given, strict=True)
            given = tuple(checked_array(self.name, key, x, size) for (key, size), x in pairs)
        result = self.kernel.general(*given, *self.added)
        return self.record(*result) if self.record else result

    def quick(self) -> Callable[..., Any]:
        """The same, quickest for single calls."""
        return self.kernel.shortcut(self, bound=self.added, largest=LARGEST, record=self.record)
