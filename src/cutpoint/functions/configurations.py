"""Configurations of a robot: neutral and random ones."""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from cutpoint.arrays import Array
from cutpoint.mechanics.system import System
from cutpoint.model import Joint, Mechanism
from cutpoint.model.limits import ENDLESS
from cutpoint.model.mechanism import Limits


def neutral(system: System) -> Array:
    """(nq,): every joint unmoved."""
    q = np.zeros(system.nq)
    for segment in system.segments:
        if not segment.follower:
            q[segment.q] = segment.joint.neutral
    return q


def at_random(
    mechanism: Mechanism,
    system: System,
    rng: "np.random.Generator",
    shape: tuple[int, ...],
    limits: Mapping[str, Limits] = MappingProxyType({}),
) -> Array:
    """(*shape, nq): see `Robot.random`.  limits: of joints by name, if they differ from the robot file's."""
    q = np.empty((*shape, system.nq))
    for segment, body in zip(system.segments, mechanism.bodies, strict=True):
        if not segment.follower:
            own = limits.get(body.joint.name, body.joint.limits)
            q[..., segment.q] = _random_coordinates(body.joint, own, segment.joint.coordinates, rng, shape)
    return q


def _random_coordinates(
    joint: Joint, limits: Limits, count: int, rng: "np.random.Generator", shape: tuple[int, ...]
) -> Array:
    """Coordinates (*shape, count) of a joint: see `Robot.random`."""
    free = np.pi if joint.kind in ("revolute", "continuous", "helical") else 1.0
    if count == 1:
        is_below, is_above = (abs(x) < ENDLESS for x in (limits.lower, limits.upper))
        lower = limits.lower if is_below else min(-free, limits.upper - 2 * free) if is_above else -free
        upper = limits.upper if is_above else max(free, lower + 2 * free)
        return rng.uniform(lower, upper, (*shape, 1))
    if joint.kind == "planar":
        return rng.uniform(-1.0, 1.0, (*shape, 3)) * [1.0, 1.0, np.pi]
    turn = rng.standard_normal((*shape, 4))
    turn /= np.linalg.norm(turn, axis=-1, keepdims=True)
    return turn if joint.kind == "spherical" else np.concatenate([rng.uniform(-1.0, 1.0, (*shape, 3)), turn], axis=-1)
