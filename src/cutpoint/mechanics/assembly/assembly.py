"""Builds the system on which the recursions work, from a mechanism and its drives.

Each body's frame is turned so that its joint's axis is z; frames, inertias and rotors follow.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache

import numpy as np

from cutpoint.arrays import Array
from cutpoint.mechanics.assembly.exact import mat3, number, pose_of, vec3
from cutpoint.mechanics.assembly.placements import inverse, joined
from cutpoint.mechanics.assembly.reframing import Framing, RevoluteFrom, framing_of
from cutpoint.mechanics.assembly.units import in_unit_of_length
from cutpoint.mechanics.bodies.joints import Floating, Helical, JointMotion, Planar, Prismatic, Revolute, Spherical
from cutpoint.mechanics.bodies.rotors import Spin, axis_of, standing_still
from cutpoint.mechanics.bodies.spatial import Inertia, Pose
from cutpoint.mechanics.system import Follower, Place, Segment, System
from cutpoint.model.drive import Drive
from cutpoint.model.mechanism import WORLD, Body, Joint, Mechanism

MOTIONS: dict[str, JointMotion] = {
    "revolute": Revolute(), "continuous": Revolute(), "prismatic": Prismatic(), "planar": Planar(),
    "spherical": Spherical(), "floating": Floating(),
}  # fmt: skip
"""Of kinds without numbers of their own."""


def system_of(mechanism: Mechanism, drives: Mapping[str, Drive], framing: Framing | None) -> System:
    """The mechanism with every joint along z, and its drives' rotors added; drives by joint name.

    framing: frames and inertias to take instead of the bodies' own, see `lean_framing`.
    """
    turns = [_turn_to_z(body) for body in mechanism.bodies]
    given = framing or _as_given(mechanism, turns)
    segments: dict[str, Segment] = {}
    places, nq, nv = _coordinates(mechanism)
    for i, body in enumerate(mechanism.bodies):
        mimic = body.joint.mimic if mechanism.coupled else None
        q, v = places[mimic.joint if mimic else body.joint.name]
        zero = number(given.zeros[i])
        follower = Follower(number(mimic.multiplier), number(mimic.offset + zero)) if mimic else None
        kind = RevoluteFrom(zero) if zero and not mimic else _motion_of(body.joint)
        placement, inertia, axes = pose_of(given.placements[i]), given.inertias[i], mat3(given.frames[i][:3, :3])
        segments[body.joint.name] = Segment(body.name, body.parent, placement, kind, inertia, q, v, axes, follower)
    frames = {f.name: Place(f.body, pose_of(_seen(given, f.body, f.placement))) for f in mechanism.frames.values()}
    system = System(tuple(segments.values()), vec3(given.gravity), frames, nq, nv, (0,) * nv)
    turning = {name for name, drive in drives.items() if drive.rotor}
    seats = {
        body.joint.name: pose_of(_seen(given, body.parent, body.placement @ turn))
        for body, turn in zip(mechanism.bodies, turns, strict=True)
        if body.joint.name in turning
    }
    return in_unit_of_length(_with_rotors(system, segments, seats, drives), given.length)


@lru_cache(maxsize=32)
def lean_framing(mechanism: Mechanism) -> Framing:
    """Frames, inertias and units that make the same equations short: see `reframing`, `regrouping` and `units`."""
    return framing_of(mechanism.bodies, [_turn_to_z(body) for body in mechanism.bodies], mechanism.gravity)


def _as_given(mechanism: Mechanism, turns: list[Array]) -> Framing:
    """Frames where the bodies have theirs, with z along the joints."""
    turned = [*zip(mechanism.bodies, turns, strict=True)]
    carriers = [np.eye(4) if body.parent == WORLD else turns[body.parent] for body in mechanism.bodies]
    placements = [joined(inverse(T), body.placement @ turn) for T, (body, turn) in zip(carriers, turned, strict=True)]
    inertias = [_inertia_of(body, turn) for body, turn in turned]
    return Framing(np.eye(4), turns, placements, [0.0] * len(turns), inertias, mechanism.gravity)


def _coordinates(mechanism: Mechanism) -> tuple[dict[str, tuple[slice, slice]], int, int]:
    """Slices of coordinates and speeds of each joint that is not a follower, and the total number of both."""
    places: dict[str, tuple[slice, slice]] = {}
    nq = nv = 0
    for body in mechanism.bodies:
        if not (mechanism.coupled and body.joint.mimic):
            kind = _motion_of(body.joint)
            places[body.joint.name] = slice(nq, nq + kind.coordinates), slice(nv, nv + len(kind.axes))
            nq, nv = nq + kind.coordinates, nv + len(kind.axes)
    return places, nq, nv


def _with_rotors(
    system: System, joints: Mapping[str, Segment], seats: Mapping[str, Pose], drives: Mapping[str, Drive]
) -> System:
    """Armature of rigid drives, spins of fully coupled ones, and the mass of rotors that no link includes yet.

    seats: frames of joints with rotors, as the user knows them with z along the axis, in their carriers' frames.
    """
    segments, armature, spins = [*system.segments], [*system.armature], []
    indices = {name: i for i, name in enumerate(joints)}
    for name, drive in drives.items():
        if not drive.rotor:
            continue
        own, rotor = joints[name], drive.rotor
        if not drive.is_elastic:
            armature[own.v.start] = drive.reflected_inertia
        if rotor.coupling == "full" and own.parent != WORLD:
            axis, J = axis_of(seats[name]), rotor.inertia
            spins.append(Spin(indices[name], own.parent, axis, J, J * drive.ratio, drive.is_elastic))
        if not rotor.in_link_inertia and own.parent != WORLD:
            carrier = segments[own.parent]
            segments[own.parent] = replace(carrier, inertia=carrier.inertia + standing_still(rotor, seats[name]))
    return replace(system, segments=tuple(segments), armature=tuple(armature), spins=tuple(spins))


def _motion_of(joint: Joint) -> JointMotion:
    return Helical(number(joint.pitch)) if joint.kind == "helical" else MOTIONS[joint.kind]


def _seen(framing: Framing, body: int, placement: Array) -> Array:
    """A placement on a body (or the world), expressed in its frame of this framing."""
    frame = framing.world if body == WORLD else framing.frames[body]
    return joined(inverse(frame), placement)


def _turn_to_z(body: Body) -> Array:
    """Rotation (4, 4) whose z axis is the joint's axis; exact where the axis is one of x, y, z."""
    kind, axis = body.joint.kind, np.asarray(body.joint.axis, float)
    return _turn_to(0.0, 0.0, 1.0) if kind in ("floating", "spherical") else _turn_to(*axis.tolist())


@lru_cache(maxsize=256)
def _turn_to(*along: float) -> Array:
    turn, z = np.eye(4), np.array(along)
    k = int(np.argmax(np.abs(z)))
    x = np.zeros(3)
    x[(k + 1) % 3] = 1.0
    if np.count_nonzero(z) > 1:
        x = x - z * (z @ x)
        x = x / np.linalg.norm(x)
    turn[:3, :3] = np.column_stack([x, np.cross(z, x), z])
    turn.flags.writeable = False
    return turn


def _inertia_of(body: Body, turn: Array) -> Inertia:
    """The body's inertia about its frame's origin, along the turned axes.  Xia (2019) eq. (60)."""
    R = turn[:3, :3]
    com = R.T @ body.com
    tensor = R.T @ body.inertia @ R + body.mass * (com @ com * np.eye(3) - np.outer(com, com))
    return Inertia(number(body.mass), vec3(body.mass * com), mat3((tensor + tensor.T) / 2))
