"""Compiled gradients of functions of a motion: of a weighted sum of outputs, by each derivative of q."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from cutpoint import kernels
from cutpoint.arrays import Array
from cutpoint.robot import Robot

MOTION = ("q", "v", "a", "jerk", "snap")
"""Inputs of functions of a motion: the position, and as many of its derivatives as they need."""

Pullback = Callable[[Array, Array], Array]


def pullback(robot: Robot, definition: Callable[..., Any], shape: tuple[int, ...], derivatives: int) -> Pullback:
    """A function (motion (5, N, n), weights (N, *shape)) -> gradient (5, N, n) of each sample's sum(weights * outputs).

    definition: of a machine and lists of scalars, the first `derivatives` + 1 of MOTION by name, with outputs of shape.
    """
    names = MOTION[: derivatives + 1]

    def weighted(weights: Any, **motion: Any) -> Any:
        return _product(weights, definition(robot.machine, **motion))

    slopes = kernels.jacobian_of(weighted, with_respect_to=names)
    sizes: dict[str, Any] = {**dict.fromkeys(names, robot.nv), "weights": shape}
    kernel = kernels.compile(slopes, name="excitation gradient", backend=robot.backend, **sizes)

    def gradient(motion: Array, weights: Array) -> Array:
        found = np.zeros_like(motion)
        found[: derivatives + 1] = kernel(*motion[: derivatives + 1], weights)
        return found

    return gradient


def _product(weights: Any, outputs: Any) -> Any:
    """The sum of elementwise products of two equally nested lists."""
    if not isinstance(outputs, Sequence):
        return weights * outputs
    return sum((_product(w, x) for w, x in zip(weights, outputs, strict=True)), 0)
