"""Energies and momentum as passes: each body's share, summed inward into the world's row."""

from collections.abc import Callable
from typing import Any

from cutpoint.kernels import Stage, View
from cutpoint.mechanics.bodies import rigid_body
from cutpoint.mechanics.bodies.spatial import IDENTITY, STILL, ZERO, Motion, Pose, Vec3, Wrench
from cutpoint.rolled.algorithms.base import Base, base_in, sizes_apart
from cutpoint.rolled.algorithms.placing import PARENT, POSE, placing
from cutpoint.rolled.bodies import BASE, Columns
from cutpoint.rolled.packing import added, flat, motion_of, pose_of
from cutpoint.rolled.passes import PLAIN, Pass, Scalars, Steps
from cutpoint.rolled.subsystem import Subsystem
from cutpoint.scalars import Scalar

Share = Callable[[Subsystem, Pose, Motion, Scalars, Pose, Motion], list[Scalar]]
"""What a body has: by its place and velocity, the speeds of its joint, and its carrier's place and velocity."""


def kinetic_energy(columns: Columns) -> Steps:
    """Kinetic energy of links and rigidly geared rotors, J."""

    def share(own: Subsystem, X: Pose, V: Motion, v: Scalars, above: Pose, carrier: Motion) -> list[Scalar]:
        turning = own.armature * v[0] * v[0] / 2
        if own.spin:
            turning = turning + own.spin.along(carrier.angular) * v[0]
        return [rigid_body.kinetic_energy(own.body.inertia, V) + turning]

    return _total(columns, share, 1, lambda total, gravity: total, ())


def potential_energy(columns: Columns) -> Steps:
    """Gravitational potential energy, J, from the sum of first moments about the world's origin."""

    def share(own: Subsystem, X: Pose, *_: Any) -> list[Scalar]:
        return [*(X.position * own.body.inertia.mass + X.rotation @ own.body.inertia.first_moment)]

    return _total(columns, share, 3, lambda total, gravity: [-Vec3(*gravity).dot(Vec3(*total))], ())


def momentum(columns: Columns) -> Steps:
    """Linear and angular momentum, about the world's origin and along its axes, kg m/s and kg m2/s."""

    def share(own: Subsystem, X: Pose, V: Motion, v: Scalars, above: Pose, carrier: Motion) -> list[Scalar]:
        spun = own.spin.axis * (own.spin.geared * v[0]) if own.spin else ZERO
        return [*(X.inward(own.body.inertia * V) + above.inward(Wrench(ZERO, spun)))]

    return _total(columns, share, 6, lambda total, gravity: total, (6,))


def _total(
    columns: Columns, share: Share, size: int, result: Callable[[Scalars, Scalars], Scalars], shape: tuple[int, ...]
) -> Steps:
    """size: of a share.  result: function of the sum of all shares, and of gravity."""
    poses, base = placing(columns, PLAIN, ("q",)), base_in(columns)

    def outward(mounting: Any, at: Any, row: Any, v: Any, turned: Any, velocity: Any) -> Any:
        X, own, above, carrier = poses.of(mounting, at), columns.subsystem(row), pose_of(turned), motion_of(velocity)
        V, X_w = X.outward(carrier) + own.body.joint.motion(v), above @ X
        return [*flat(X_w.rotation), *X_w.position], [*V], share(own, X_w, V, v, above, carrier)

    def whole(total: Any, gravity: Any, *of_base: Any) -> Any:
        return [*result([sum(x) for x in zip(total, *of_base, strict=True)], gravity)]

    passes = [
        Pass("alone", poses.stage),
        Pass("once", Stage(lambda: [0] * size, (), ("world.share",))),
        *([_of_base(base, share)] if base else []),
        Pass("outward", Stage(outward, (*POSE, "body", "v", "above", "carrier"), ("turned", "velocity", "share"))),
        Pass("inward", Stage(added, ("share", "borne"), ("borne",))),
        Pass("once", Stage(whole, ("world.share", "gravity", *(["base.share"] if base else [])), ("total",))),
    ]
    views = (PARENT, View("carrier", "velocity", "parent"), View("borne", "share", "parent"))
    kept, numbers = {"pose": poses.size, "turned": 12, "velocity": 6, "share": size}, ("q", "v")
    sizes, constants = sizes_apart(base, numbers)
    apart, known = {**sizes, "total": sum(shape) or 1}, {**constants, "gravity": 3}
    return Steps(kept, numbers, views, {"turned": flat(IDENTITY)}, passes, apart, known, {"total": shape})


def _of_base(base: Base, share: Share) -> Pass:
    def moves(row: Any, q: Any, v: Any) -> Any:
        own = base.segment(row)
        X, V = own.placement @ own.joint.pose(q), own.joint.motion(v)
        has = share(Subsystem(own, 0, None, BASE, BASE), X, V, v, Pose(IDENTITY, ZERO), STILL)
        return [*flat(X.rotation), *X.position], [*V], has

    writes = [f"base.{name}" for name in ("turned", "velocity", "share")]
    return Pass("once", Stage(moves, ("base.body", "base.q", "base.v"), writes))
