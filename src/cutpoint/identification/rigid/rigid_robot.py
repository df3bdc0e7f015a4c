"""The identified rigid model, and its motor torques for a motion."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.identification.conditioning.motion import Motion, sliding_speeds
from cutpoint.identification.rigid.bodies import with_parameters
from cutpoint.identification.triangle import CHUNK
from cutpoint.mechanics.drives.friction import Coulomb, Sliding
from cutpoint.mechanics.drives.presliding import sliding_of
from cutpoint.model.drive import Drive, Friction, KinematicError, Rotor
from cutpoint.robot import Robot

AT_REST = 0.02
"""Smoothing of friction's sign change, as a share of the RMS speed, if a drive states no friction."""

LEAST = 1e-6
"""Least inertia of a rotor behind a spring, as a share of the inertia at the joint."""


@dataclass(frozen=True, eq=False)
class RigidModel:
    """torque = Y(q, v, a) inertial + rotors w_dot + friction(v) + offsets - e'(theta) load, for all joints of a robot.

    inertial (10 bodies,); rotors (n,) kg m2 at the joint; offsets (n,) N m; laws by joint, of both sides together.
    of_links: by joint, the link's part of its law, which the drive transmits.
    on_motor (n,): joints whose friction depends on the motor's speed, others' on the link's.
    errors: by joint, kinematic errors, which vary the motor's share of the load.
    """

    inertial: Array
    rotors: Array
    offsets: Array
    laws: Mapping[str, Sliding]
    of_links: Mapping[str, Friction]
    on_motor: NDArray[np.bool_]
    errors: Mapping[str, KinematicError]

    def torque(self, robot: Robot, motion: Motion) -> Array:
        """(N, n), NaN where the motion is unknown."""
        links = link_torques(robot, motion, self.inertial)
        loads = transmitted(robot, motion, links, self.of_links)
        found = links + self.rotors * motion.w_dot + self.offsets - error_slopes(robot, motion, self.errors) * loads
        speeds = np.where(self.on_motor, motion.w, motion.v)
        for j, joint in enumerate(robot.joints):
            found[:, j] += self.laws[joint].torque(speeds[:, j], loads[:, j])
        return found

    def robot(self, robot: Robot) -> Robot:
        """The robot with these bodies, rotors and friction; springs, limits and motors are unchanged."""
        arm = np.diag(robot.mass_matrix(robot.neutral()))
        drives = {
            joint: _driven(drive, self.laws[joint], float(self.rotors[j]), LEAST * float(arm[j]))
            for j, (joint, drive) in enumerate(robot.drives.items())
        }
        return Robot(with_parameters(robot.mechanism, self.inertial), drives, backend=robot.backend)


def link_torques(robot: Robot, motion: Motion, inertial: Array) -> Array:
    """(N, n): the links' joint torques for inertial parameters (10 bodies,); NaN where the motion is unknown."""
    found = np.full(motion.q.shape, np.nan)
    known = np.flatnonzero(np.isfinite(np.column_stack([motion.q, motion.v, motion.a])).all(axis=1))
    for start in range(0, known.size, CHUNK):
        rows = known[start : start + CHUNK]
        found[rows] = robot.regressor(motion.q[rows], motion.v[rows], motion.a[rows]) @ inertial
    return found


def transmitted(robot: Robot, motion: Motion, links: Array, of_links: Mapping[str, Friction]) -> Array:
    """(N, n) N m: the drives' loads, on which their friction depends: the links' torques, (N, n), and their friction.

    of_links: by joint.
    """
    found = links.copy()
    for joint, law in of_links.items():
        j = robot.joints.index(joint)
        found[:, j] += law.torque(motion.v[:, j])
    return found


def error_slopes(robot: Robot, motion: Motion, errors: Mapping[str, KinematicError]) -> Array:
    """(N, n): e'(theta), the share of its load by which each drive relieves its motor; 0 without an error.

    Xia (2019) eqs. (22), (27).
    """
    found = np.zeros_like(motion.theta)
    for joint, error in errors.items():
        j = robot.joints.index(joint)
        found[:, j] = error.slope(motion.theta[:, j], robot.drives[joint].ratio)
    return found


def friction_of_links(robot: Robot, laws: Mapping[str, Sliding], known: Mapping[str, Friction]) -> dict[str, Friction]:
    """By joint, known link friction, or the link's share of its law in a drive that states both sides."""
    drives = ((joint, robot.drives[joint], law) for joint, law in laws.items())
    stated = {joint: _shared(drive, law)["link_friction"] for joint, drive, law in drives if _states_both(drive)}
    return stated | dict(known)


def stated_laws(robot: Robot, motion: Motion) -> dict[str, Sliding]:
    """The sliding law of each joint's drive, of two the one with more effects; Coulomb's if it states none."""
    found = coulomb_laws(robot, sliding_speeds(robot, motion))
    for joint, drive in robot.drives.items():
        sides = sliding_of(drive.link_friction), sliding_of(drive.motor_friction)
        stated = [law for law in sides if law is not None]
        found[joint] = max(stated, key=_effects, default=found[joint])
    return found


def coulomb_laws(robot: Robot, speeds: Array) -> dict[str, Sliding]:
    """Default laws by joint, for speeds (N, n), rad/s."""
    smoothings = np.maximum(AT_REST * np.sqrt(np.nanmean(speeds**2, axis=0)), 1e-9).tolist()
    return {joint: Coulomb(1.0, 0.0, smoothing) for joint, smoothing in zip(robot.joints, smoothings, strict=True)}


def _effects(law: Sliding) -> int:
    """The number of effects in a law."""
    return len(law.coefficients) + (law.per_load is not None) + (law.asymmetry is not None)


def is_stated(robot: Robot, joint: str) -> bool:
    """Whether a joint's drive states friction."""
    drive = robot.drives[joint]
    return drive.link_friction is not None or drive.motor_friction is not None


def stated_coefficient(robot: Robot, name: str) -> float:
    """The drive's stated value of `coulomb.joint1`, both sides together; NaN if it states none, 0 for an offset."""
    kind, _, joint = name.partition(".")
    sides = _sides(robot.drives[joint], kind)
    return 0.0 if kind == "offset" else sum(sides.values()) if sides else float("nan")


def _sides(drive: Drive, coefficient: str) -> dict[str, float]:
    """A friction coefficient as stated on each side of a drive; Coulomb's holds at rest too."""
    found: dict[str, float] = {}
    for side in ("link_friction", "motor_friction"):
        law: Any = getattr(drive, side)
        law = sliding_of(law)
        value = getattr(law, coefficient, getattr(law, "coulomb", None) if coefficient == "static" else None)
        if value is not None:
            found[side] = float(value)
    return found


def laws_with(laws: Mapping[str, Sliding], values: Mapping[str, float]) -> dict[str, Sliding]:
    """The laws with a regression's coefficients, such as `coulomb.joint1`."""
    found: dict[str, Sliding] = {}
    for joint, law in laws.items():
        law = law.with_coefficients([values[f"{name}.{joint}"] for name in law.coefficients])
        own: Any = law
        found[joint] = law if law.per_load is None else replace(own, per_load=values.get(f"per_load.{joint}", 0.0))
    return found


def _driven(drive: Drive, law: Sliding, reflected: float, least: float) -> Drive:
    """The drive with an identified rotor, whose mass is in the links', and its friction on the sides that state it: in
    their stated shares, with all load-dependent friction on the motor's; on the link's if none states it."""
    inertia = max(reflected, least if drive.is_elastic else 0.0) / drive.ratio**2
    rotor = drive.rotor or (Rotor(0.0) if inertia else None)
    rotor = rotor and replace(rotor, inertia=inertia, in_link_inertia=True)
    if _states_both(drive):
        laws = _shared(drive, law)
    else:
        on_motor = law.per_load is not None or drive.motor_friction is not None
        laws = {"motor_friction": law if on_motor else None, "link_friction": None if on_motor else law}
    return replace(drive, rotor=rotor, **{side: _as_stated(getattr(drive, side), x) for side, x in laws.items()})


def _states_both(drive: Drive) -> bool:
    return drive.link_friction is not None and drive.motor_friction is not None


def _shared(drive: Drive, law: Any) -> dict[str, Any]:
    """A law split into those of two sides, by the shares that the drive states."""
    shares = {name: _share_of_motor(drive, name) for name in law.coefficients}
    link = _part(law, {name: 1.0 - share for name, share in shares.items()})
    return {"motor_friction": _part(law, shares), "link_friction": replace(link, per_load=None)}


def _part(law: Any, shares: Mapping[str, float]) -> Any:
    """A law with a share of each coefficient; of static friction, with a share of its excess over Coulomb's."""
    own = {name: share * float(getattr(law, name)) for name, share in shares.items()}
    if "static" in own:
        own["static"] = own["coulomb"] + shares["static"] * float(law.static - law.coulomb)
    return law.with_coefficients([*own.values()])


def _share_of_motor(drive: Drive, coefficient: str) -> float:
    """The motor's share of what both sides state, a half if they state nothing; at rest, of the excess over motion, so
    that neither side's friction is less at rest."""
    sides = _sides(drive, coefficient)
    if coefficient == "static":
        sides = {side: x - _sides(drive, "coulomb")[side] for side, x in sides.items()}
    total = sum(sides.values())
    return sides.get("motor_friction", 0.0) / total if total > 0.0 else 0.5


def _as_stated(stated: Any, law: Sliding | None) -> Any:
    """The law as the sliding part of stated bristles."""
    keeps = law is not None and hasattr(stated, "sliding") and getattr(law, "coulomb", 0.0) > 0
    return replace(stated, sliding=law) if keeps else law
