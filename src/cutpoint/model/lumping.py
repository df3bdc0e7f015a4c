"""Mass properties of rigidly connected pieces."""

from typing import NamedTuple

import numpy as np

from cutpoint.arrays import Array


class MassProperties(NamedTuple):
    """mass in kg; com (3,) in m; inertia (3, 3) in kg m2 about the com: com and inertia in one stated frame."""

    mass: float
    com: Array
    inertia: Array

    @property
    def is_nothing(self) -> bool:
        """Whether there is neither mass nor inertia."""
        return self.mass == 0.0 and not np.any(self.inertia)


NO_MASS = MassProperties(0.0, np.zeros(3), np.zeros((3, 3)))


def placed(placement: Array, piece: MassProperties) -> MassProperties:
    """The piece in the parent frame of a placement (4, 4)."""
    rotation, translation = placement[:3, :3], placement[:3, 3]
    return MassProperties(piece.mass, rotation @ piece.com + translation, rotation @ piece.inertia @ rotation.T)


def lumped(a: MassProperties, b: MassProperties) -> MassProperties:
    """Two pieces as one, both in the same frame: the parallel-axis theorem about the common com."""
    mass = a.mass + b.mass
    if a.mass == 0.0 or b.mass == 0.0:
        heavier = a if b.mass == 0.0 else b
        return MassProperties(mass, heavier.com, a.inertia + b.inertia)
    apart = b.com - a.com
    steiner = (a.mass * b.mass / mass) * (apart @ apart * np.eye(3) - np.outer(apart, apart))
    return MassProperties(mass, a.com + (b.mass / mass) * apart, a.inertia + b.inertia + steiner)
