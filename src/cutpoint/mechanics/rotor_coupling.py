"""Rotors behind springs, with the links that carry them: the mass matrix [M, S; S^T, J].  De Luca and Tomei (1996)."""

from collections.abc import Sequence

import numpy as np

from cutpoint.arrays import Array
from cutpoint.mechanics.kinematics import joint_poses
from cutpoint.mechanics.system import Driven, System
from cutpoint.model.mechanism import WORLD


def rotor_coupling(system: System, drives: Sequence[Driven], q: Array) -> Array:
    """S(q), (nv, drives): inertial coupling of rotors with the joints that turn their carriers, kg m2 at the joint.

    Nonzero only for rotors with full coupling behind springs.
    """
    S = np.zeros((system.nv, len(drives)))
    if not system.has_sprung_rotors:
        return S
    turns: list[Array] = []
    axes, moved_by = np.zeros((system.nv, 3)), np.zeros((len(system.segments), system.nv), bool)
    # outward: each body's orientation, and the speeds that turn it
    for i, (body, X) in enumerate(zip(system.segments, joint_poses(system, q.tolist()), strict=True)):
        own = np.array([[*row] for row in X.rotation], np.float64)
        turns.append(own if body.parent == WORLD else turns[body.parent] @ own)
        moved_by[i] = moved_by[body.parent] if body.parent != WORLD else False
        for k, z in body.columns():
            axes[k], moved_by[i, k] = turns[i] @ [*z.angular], True
    drive_of = {d.segment: k for k, d in enumerate(drives)}
    for spin in system.spins:
        if spin.elastic:
            along = axes @ (turns[spin.carrier] @ [*spin.axis])
            S[:, drive_of[spin.joint]] = spin.geared * along * moved_by[spin.carrier]
    return S


def rotor_mobility(drives: Sequence[Driven]) -> Array:
    """1 / J (drives,), 1/(kg m2); zero for rigid drives, whose rotors are armature."""
    each = [d.drive for d in drives]
    return np.array([1.0 / drive.reflected_inertia if drive.is_elastic else 0.0 for drive in each], np.float64)


def without_rotors(drives: Sequence[Driven], M: Array, S: Array) -> Array:
    """M - S J^-1 S^T, (nv, nv): the links' inertia while rotors behind springs do not follow their carriers."""
    return M - S * rotor_mobility(drives) @ S.T
