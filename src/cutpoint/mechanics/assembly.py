"""From a mechanism and its drives to the system that the recursions want.

Each body's frame is turned so that its joint's axis is z; frames, inertias and rotors follow.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from cutpoint.mechanics.joints import Floating, Helical, JointKind, Planar, Prismatic, Revolute, Spherical
from cutpoint.mechanics.rotors import Spin, axis_of, standing_still
from cutpoint.mechanics.spatial import Inertia, Mat3, Pose, Vec3
from cutpoint.mechanics.system import Follower, Place, Segment, System
from cutpoint.model.drive import Drive
from cutpoint.model.mechanism import WORLD, Array, Body, Joint, Mechanism
from cutpoint.scalars import Scalar

KINDS: dict[str, JointKind] = {
    "revolute": Revolute(), "continuous": Revolute(), "prismatic": Prismatic(), "planar": Planar(),
    "spherical": Spherical(), "floating": Floating(),
}  # fmt: skip
"""Kinds without numbers of their own."""


def system_of(mechanism: Mechanism, drives: Mapping[str, Drive] | None = None) -> System:
    """The mechanism with every joint along z, and with what its drives' rotors add to it; drives by joint name."""
    turns = [_turn_to_z(body) for body in mechanism.bodies]
    segments: dict[str, Segment] = {}
    places, nq, nv = _coordinates(mechanism)
    for body, turn in zip(mechanism.bodies, turns, strict=True):
        kind, mimic = _kind_of(body.joint), body.joint.mimic if mechanism.coupled else None
        q, v = places[mimic.joint if mimic else body.joint.name]
        follower = Follower(number(mimic.multiplier), number(mimic.offset)) if mimic else None
        placement, axes = _turned(turns, body.parent, body.placement @ turn), mat3(turn[:3, :3])
        inertia = _inertia_of(body, turn)
        segments[body.joint.name] = Segment(body.name, body.parent, placement, kind, inertia, q, v, axes, follower)
    frames = {f.name: Place(f.body, _turned(turns, f.body, f.placement)) for f in mechanism.frames.values()}
    system = System(tuple(segments.values()), vec3(mechanism.gravity), frames, nq, nv, (0,) * nv)
    return _with_rotors(system, segments, drives or {})


def _coordinates(mechanism: Mechanism) -> tuple[dict[str, tuple[slice, slice]], int, int]:
    """Where each joint that is no follower has its coordinates and speeds, and how many there are of both."""
    places: dict[str, tuple[slice, slice]] = {}
    nq = nv = 0
    for body in mechanism.bodies:
        if not (mechanism.coupled and body.joint.mimic):
            kind = _kind_of(body.joint)
            places[body.joint.name] = slice(nq, nq + kind.coordinates), slice(nv, nv + len(kind.axes))
            nq, nv = nq + kind.coordinates, nv + len(kind.axes)
    return places, nq, nv


def _with_rotors(system: System, joints: Mapping[str, Segment], drives: Mapping[str, Drive]) -> System:
    """Armature of rigid drives, spins of fully coupled ones, and the mass of rotors that no link holds yet."""
    segments, armature, spins = [*system.segments], [*system.armature], []
    indices = {name: i for i, name in enumerate(joints)}
    for name, drive in drives.items():
        if not drive.rotor:
            continue
        own, rotor = joints[name], drive.rotor
        if not drive.is_elastic:
            armature[own.v.start] = drive.reflected_inertia
        if rotor.coupling == "full" and own.parent != WORLD:
            axis, J = axis_of(own.placement), rotor.inertia
            spins.append(Spin(indices[name], own.parent, axis, J, J * drive.ratio, drive.is_elastic))
        if not rotor.in_link_inertia and own.parent != WORLD:
            carrier = segments[own.parent]
            segments[own.parent] = replace(carrier, inertia=carrier.inertia + standing_still(rotor, own.placement))
    return replace(system, segments=tuple(segments), armature=tuple(armature), spins=tuple(spins))


def _kind_of(joint: Joint) -> JointKind:
    return Helical(number(joint.pitch)) if joint.kind == "helical" else KINDS[joint.kind]


def _turned(turns: Sequence[Array], body: int, placement: Array) -> Pose:
    """A placement on a body, seen from the body's turned frame."""
    return pose_of(placement if body == WORLD else turns[body].T @ placement)


def _turn_to_z(body: Body) -> Array:
    """Rotation (4, 4) whose z axis is the joint's axis; exact where the axis is one of x, y, z."""
    turn = np.eye(4)
    if body.joint.kind in ("floating", "spherical"):
        return turn
    z = np.asarray(body.joint.axis, float)
    k = int(np.argmax(np.abs(z)))
    x = np.zeros(3)
    x[(k + 1) % 3] = 1.0
    if np.count_nonzero(z) > 1:
        x = x - z * (z @ x)
        x = x / np.linalg.norm(x)
    turn[:3, :3] = np.column_stack([x, np.cross(z, x), z])
    return turn


def _inertia_of(body: Body, turn: Array) -> Inertia:
    """The body's inertia about its frame's origin, along the turned axes.  Xia (2019) eq. (60)."""
    R = turn[:3, :3]
    com = R.T @ body.com
    tensor = R.T @ body.inertia @ R + body.mass * (com @ com * np.eye(3) - np.outer(com, com))
    return Inertia(number(body.mass), vec3(body.mass * com), mat3((tensor + tensor.T) / 2))


def number(x: float) -> Scalar:
    """A float, or a whole number where it is 0, 1 or -1, so that it vanishes when traced and stays exact."""
    return int(x) if x in (-1.0, 0.0, 1.0) else float(x)


def vec3(v: Array) -> Vec3:
    return Vec3(*(number(x) for x in v))


def mat3(A: Array) -> Mat3:
    return Mat3(*(vec3(row) for row in A))


def pose_of(matrix: Array) -> Pose:
    """A (4, 4) pose as scalars."""
    return Pose(mat3(matrix[:3, :3]), vec3(matrix[:3, 3]))
