"""Which of two bodies carries the other, for stages over pairs of bodies."""

from collections.abc import Sequence
from typing import NamedTuple

from cutpoint.scalars import Scalar

Scalars = Sequence[Scalar]


class Related(NamedTuple):
    """Whether one body of a pair carries the other, is carried by it, and is the other; each carries itself."""

    carries: Scalar
    is_carried: Scalar
    is_same: Scalar


class Kinship(NamedTuple):
    """What is known about pairs before their numbers are read.

    name: of the lists that say which pairs.  carries, is_carried: whether one may carry the other, and be carried.
    is_sure: whether that is certain, so that nothing need be read.
    """

    name: str
    carries: bool
    is_carried: bool
    is_sure: bool

    @property
    def lists(self) -> tuple[str, str, str]:
        """Names of the lists of bodies, of others, and of the positions of their entries."""
        return f"{self.name}.body", f"{self.name}.other", f"{self.name}.entry"

    def of(self, own: Scalars, other: Scalars) -> Related:
        """own, other: spans, which begin with the body's number and the last number that it carries."""
        if self.is_sure:
            return Related(self.carries, self.is_carried, False)
        (number, last), (its_number, its_last) = own[:2], other[:2]
        carries = self.carries and (number <= its_number) & (its_number <= last)
        is_carried = self.is_carried and (its_number <= number) & (number <= its_last)
        return Related(carries, is_carried, carries & is_carried if self.carries and self.is_carried else False)


def kinships(*, is_sure: bool) -> list[Kinship]:
    """All kinships; each leaves out the contributions that are zero for its pairs.

    is_sure: of two different bodies, one by one.  A body paired with itself is treated like one with a whole block of
    others, so that both round alike.
    """
    apart = Kinship("carrying", True, False, is_sure), Kinship("carried", False, True, is_sure)
    return [*apart, Kinship("mixed", True, True, is_sure=False)]
