"""The mass matrix as passes: composite inertias inward, then every pair of bodies.

All quantities are about one point and along the world's axes, where what bodies carry is a plain sum.  The first joint
of each tree is there, however far from the world's origin it is mounted, and so is a floating base.
"""

from typing import Any

from cutpoint.kernels import Stage, View
from cutpoint.mechanics.bodies.rigid_body import inertia_of, parameters_of
from cutpoint.mechanics.bodies.spatial import IDENTITY, ZERO, Vec3, Wrench
from cutpoint.rolled.algorithms.base import base_in, sizes_apart
from cutpoint.rolled.algorithms.placing import PARENT, world_poses
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.kinship import Kinship
from cutpoint.rolled.packing import added, flat, motion_of, pose_of, wrench_of
from cutpoint.rolled.passes import Pass, Steps
from cutpoint.scalars import where


def mass_matrix(columns: Columns) -> Steps:
    """M(q), kg m2 (kg).  Featherstone (2008) section 6.2.

    column: the motion of body and all it carries at unit speed of its joint.  momentum: what they then have, with that
    of the rotor that turns them.  span: the body's number, the last number that it carries, and what the joint alone
    feels of its rotor.
    """
    base = base_in(columns)
    placed, kept = world_poses(columns, [base.stands()] if base else [])

    def alone(row: Any, turned: Any) -> Any:
        body, X = columns.subsystem(row).body, pose_of(turned)
        return [*body.joint.motion([1]).seen_from_parent(X)], parameters_of(body.inertia.seen_from_parent(X))

    def momentum(row: Any, turned: Any, column: Any, carried: Any) -> Any:
        own, motion = columns.subsystem(row), motion_of(column)
        F, felt = inertia_of(carried) * motion, own.armature
        if own.spin:
            tie = Wrench(ZERO, pose_of(turned).rotation @ Vec3(0, 0, 1) * own.spin.geared)
            F, felt = F + tie, felt - motion.power(tie)
        return [*F], [own.number, own.last, felt]

    passes = [
        *placed,
        Pass("alone", Stage(alone, ("body", "turned"), ("column", "carried"))),
        Pass("inward", Stage(added, ("carried", "borne"), ("borne",))),
        Pass("alone", Stage(momentum, ("body", "turned", "column", "carried"), ("momentum", "span"))),
        *(base.couples() if base else []),
        Pass("pairs", Stage(_entry, ("held", "column", "momentum", "span"), ("matrix",))),
    ]
    views = (PARENT, View("borne", "carried", "parent"))
    kept |= {"column": 6, "carried": 10, "momentum": 6, "span": 3}
    tied, apart = ({"matrix_rows": base.axes}, {"base.matrix": base.axes**2}) if base else ({}, {})
    sizes, constants = sizes_apart(base, ("q",))
    world = {"turned": flat(IDENTITY)}
    return Steps({**kept, **tied}, ("q",), views, world, passes, {**sizes, **apart}, constants)


def _entry(kin: Kinship, held: Any, column: Any, momentum: Any, span: Any) -> Any:
    """The power of one body's momentum by the other's motion, if one carries the other."""
    motion, F, own_span = motion_of(held[:6]), wrench_of(held[6:12]), held[12:]
    carries, is_carried, is_same = kin.of(own_span, span)
    coupled = where(carries, motion.power(wrench_of(momentum)), where(is_carried, motion_of(column).power(F), 0))
    return [where(is_same, coupled + own_span[2], coupled)]
