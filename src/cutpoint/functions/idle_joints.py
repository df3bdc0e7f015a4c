"""Joints that move no inertia, for which functions that divide by inertia are singular."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cutpoint import definitions
from cutpoint.definitions import Machine
from cutpoint.errors import ModelError, listed
from cutpoint.functions.configurations import at_random
from cutpoint.mechanics.bodies.spatial import IDENTITY, ZERO, Inertia
from cutpoint.mechanics.kinematics import joint_poses
from cutpoint.mechanics.mass_matrix import composite_inertias
from cutpoint.mechanics.rotor_coupling import rotor_coupling, without_rotors
from cutpoint.mechanics.system import System
from cutpoint.model import Mechanism

INERTIA_ROUNDING = 1e-13
"""Share of the inertia that a motion could move at most: with less it moves none."""

MOST_BODIES = 200
"""Bodies of the largest robot of which all motions are looked at, up to a second; of larger ones it is each joint's."""

CONFIGURATIONS = 3
"""At random, at all of which inertia must be missing: at a single one two axes may happen to fall together."""


def check_moves_inertia(mechanism: Mechanism, machine: Machine) -> None:
    """Raises ModelError, with the joints' names, if joints can move without moving positive inertia."""
    if not machine.system.nv:
        return
    if len(mechanism.bodies) > MOST_BODIES:
        if idle := _idle_alone(mechanism, machine.system):
            raise ModelError(_complaint(idle[:1], True), joints=idle)
        return
    for follow in (True, False) if machine.system.has_sprung_rotors else (True,):
        rng, idle = np.random.default_rng(0), list[str]()
        for _ in range(CONFIGURATIONS):
            idle = _idle_joints(mechanism, machine, rng, follow)
            if not idle:
                break
        if idle:
            raise ModelError(_complaint(idle, follow), joints=idle)


def _idle_alone(mechanism: Mechanism, system: System) -> list[str]:
    """Joints of which each moves no inertia while all others stand still."""
    both = system, _spread(system)
    own, most = (_alone(x, [body.inertia for body in x.segments]) for x in both)
    if (own > INERTIA_ROUNDING * most).all():
        return []
    X = joint_poses(system, at_random(mechanism, system, np.random.default_rng(0), ()).tolist())
    carried, most = (_alone(x, composite_inertias(x, X)) for x in both)
    return list(dict.fromkeys(_names(mechanism, system)[carried <= INERTIA_ROUNDING * most]))


def _alone(system: System, inertias: Sequence[Inertia]) -> "np.ndarray":
    """(nv,): inertia that each coordinate moves by itself, if bodies have these; those of followers add up."""
    found = np.array(system.armature, float)
    for body, inertia in zip(system.segments, inertias, strict=True):
        for v, z in body.columns():
            found[v] += z.power(inertia * z)
    return found


def _complaint(idle: list[str], follow: bool) -> str:
    """follow: whether rotors turned along with their carriers."""
    which = f"joint {idle[0]!r} can move" if len(idle) == 1 else f"joints {listed(idle)} can move against each other"
    if follow:
        remedy = "give a moving link inertia (<inertial>) or a drive a rotor (armature), or lock a joint"
        return f"{which} without moving any inertia, so that no force determines how fast; {remedy}"
    found = "with no inertia or a negative one: nothing is left of a link's beside rotors with full coupling"
    remedy = "state in_link_inertia: false for drives whose rotors it leaves out, or correct the link's <inertial>"
    return f"{which} {found}; {remedy}"


def _idle_joints(mechanism: Mechanism, machine: Machine, rng: "np.random.Generator", follow: bool) -> list[str]:
    """Joints that take part in the motion of least inertia at a random configuration, if that inertia is not positive.

    follow: whether rotors behind springs turn along with their carriers.
    """
    system = machine.system
    q, names = at_random(mechanism, system, rng, ()), _names(mechanism, system)
    M, most = (np.array(definitions.mass_matrix(Machine(x, []), q.tolist()), float) for x in (system, _spread(system)))
    M = M if follow else without_rotors(machine.drives, M, rotor_coupling(*machine, q))
    scale = np.sqrt(np.diag(most))
    scale[scale == 0.0] = 1.0
    values, vectors = np.linalg.eigh(M / np.outer(scale, scale))
    share = np.abs(vectors[:, 0])
    return list(dict.fromkeys(names[share > 0.1 * share.max()])) if values[0] < INERTIA_ROUNDING else []


def _names(mechanism: Mechanism, system: System) -> "np.ndarray":
    """(nv,): the joint of each coordinate."""
    names = np.empty(system.nv, object)
    for segment, body in zip(system.segments, mechanism.bodies, strict=True):
        if not segment.follower:
            names[segment.v] = body.joint.name
    return names


def _spread(system: System) -> System:
    """The system with bodies that resist all motions of their frames, by as much as the originals resist any."""
    bodies = [replace(s, inertia=_spread_inertia(s.inertia)) for s in system.segments]
    return replace(system, segments=tuple(bodies), spins=())


def _spread_inertia(inertia: Inertia) -> Inertia:
    xx, yy, zz = (row[k] for k, row in enumerate(map(tuple, inertia.rotational)))
    return Inertia(inertia.mass, ZERO, IDENTITY * (xx + yy + zz))
