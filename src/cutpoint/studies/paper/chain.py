"""A robot as the plain arrays that textbook formulations read: no spatial vectors, no code shared with `mechanics`."""

from dataclasses import dataclass
from typing import Any, Literal, cast

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.errors import ModelError
from cutpoint.model.mechanism import Body, Mechanism

Numbers = NDArray[Any]
"""Real numbers, or complex ones for complex-step derivatives."""
Kind = Literal["revolute", "prismatic"]


@dataclass(frozen=True, eq=False)
class Chain:
    """A tree of n bodies, parents before children, one revolute or prismatic joint each.

    parents: index of the carrying body, or -1 for the world.  placements (n, 4, 4): joint frame at coordinate zero, in
    the parent's frame.  axes (n, 3): unit vectors in the joint's frame, which is the body's frame too.  masses (n,) in
    kg; coms (n, 3) in m; inertias (n, 3, 3) in kg m2 about the coms, along the body's axes.  gravity (3,): acceleration
    of free fall in the world's frame, m/s2.
    """

    parents: tuple[int, ...]
    placements: Array
    axes: Array
    kinds: tuple[Kind, ...]
    masses: Array
    coms: Array
    inertias: Array
    gravity: Array


@dataclass(frozen=True, eq=False)
class Places:
    """Poses of all bodies in the world, for samples (...), with body indices i = 0 ... n - 1.

    rotations (..., n, 3, 3): body axes to world axes.  origins, centroids, axes (..., n, 3).
    """

    rotations: Numbers
    origins: Numbers
    centroids: Numbers
    axes: Numbers


def chain_of(mechanism: Mechanism) -> Chain:
    """The mechanism's bodies as arrays.

    Raises:
        ModelError: a body without a revolute or prismatic joint of its own coordinate.
    """
    bodies = mechanism.bodies
    return Chain(
        parents=tuple(body.parent for body in bodies),
        placements=np.array([body.placement for body in bodies]),
        axes=np.array([body.joint.axis for body in bodies]),
        kinds=tuple(_kind(body, mechanism.coupled) for body in bodies),
        masses=np.array([body.mass for body in bodies]),
        coms=np.array([body.com for body in bodies]),
        inertias=np.array([body.inertia for body in bodies]),
        gravity=np.array(mechanism.gravity),
    )


def places(chain: Chain, q: Numbers) -> Places:
    """Forward kinematics at coordinates q (..., n), real or complex."""
    rotations, origins = [], []
    for i, parent in enumerate(chain.parents):
        R, p = _on_parent(chain, i, q[..., i])
        if parent >= 0:
            p = origins[parent] + _turn(rotations[parent], p)
            R = rotations[parent] @ R
        rotations.append(R)
        origins.append(p)
    R, p = np.stack(rotations, axis=-3), np.stack(origins, axis=-2)
    return Places(R, p, centroids=p + _turn(R, chain.coms), axes=_turn(R, chain.axes))


def _on_parent(chain: Chain, i: int, q: Numbers) -> tuple[Numbers, Numbers]:
    """Rotation (..., 3, 3) and origin (..., 3) of body i in its parent's frame."""
    R, p, axis = chain.placements[i, :3, :3], chain.placements[i, :3, 3], chain.axes[i]
    if chain.kinds[i] == "revolute":
        return R @ _about(axis, q), np.broadcast_to(p, (*q.shape, 3))
    return np.broadcast_to(R, (*q.shape, 3, 3)), p + q[..., None] * (R @ axis)


def _about(axis: Array, angle: Numbers) -> Numbers:
    """Rotation matrices (..., 3, 3) about a unit axis: Rodrigues' formula."""
    K = np.cross(np.eye(3), axis)  # row i: (e_i x axis) . w = e_i . (axis x w)
    s, c = np.sin(angle)[..., None, None], np.cos(angle)[..., None, None]
    return np.eye(3) + s * K + (1 - c) * (K @ K)


def _turn(R: Numbers, vectors: Numbers) -> Numbers:
    return np.einsum("...ij,...j->...i", R, vectors)


def _kind(body: Body, coupled: bool) -> Kind:
    joint = body.joint
    if joint.kind not in ("revolute", "continuous", "prismatic"):
        raise ModelError(
            f"joint {joint.name!r}: a {joint.kind} joint does not fit a chain of revolute and prismatic joints; "
            "fix the base, or compare by another formulation",
            joint=joint.name,
        )
    if coupled and joint.mimic is not None:
        raise ModelError(
            f"joint {joint.name!r} follows {joint.mimic.joint!r}; a chain needs a coordinate for every joint: "
            "build the mechanism with coupled=False",
            joint=joint.name,
        )
    return cast(Kind, "prismatic" if joint.kind == "prismatic" else "revolute")
