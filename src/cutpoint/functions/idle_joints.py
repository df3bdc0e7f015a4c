"""Joints that can move while nothing with inertia does: what divides by inertia has no answer for them."""

from dataclasses import replace

import numpy as np

from cutpoint import definitions
from cutpoint.definitions import Machine
from cutpoint.errors import ModelError, listed
from cutpoint.functions.configurations import at_random
from cutpoint.mechanics.spatial import IDENTITY, ZERO, Inertia
from cutpoint.mechanics.system import System
from cutpoint.model import Mechanism

ROUNDING = 1e-13
"""Of the inertia that a motion could move at most."""

MOST = 200
"""Bodies of the largest robot that is looked at: a third of a second."""

CONFIGURATIONS = 3
"""At random, at all of which inertia must be missing: at a single one two axes may happen to fall together."""


def check_moves_inertia(mechanism: Mechanism, machine: Machine) -> None:
    """Raises ModelError, with the joints, if they can move while nothing with inertia does, or less than nothing."""
    if not machine.system.nv or len(mechanism.bodies) > MOST:
        return
    rng = np.random.default_rng(0)
    idle: list[str] = []
    for _ in range(CONFIGURATIONS):
        idle = _idle_joints(mechanism, machine, rng)
        if not idle:
            return
    which = f"joint {idle[0]!r} can move" if len(idle) == 1 else f"joints {listed(idle)} can move against each other"
    remedy = "give a link that moves inertia (<inertial>), a drive a rotor (armature), or lock a joint"
    if machine.system.has_sprung_rotors:
        remedy += "; rotors with full coupling are in their links' inertia unless in_link_inertia is false"
    complaint = f"{which} while nothing with inertia moves, so that no force decides how fast; {remedy}"
    raise ModelError(complaint, joints=idle)


def _idle_joints(mechanism: Mechanism, machine: Machine, rng: "np.random.Generator") -> list[str]:
    """Joints that take part in the motion of least inertia at a random configuration, if that is none."""
    system = machine.system
    q, names = at_random(mechanism, system, rng, ()), np.empty(system.nv, object)
    for segment, body in zip(system.segments, mechanism.bodies, strict=True):
        if not segment.follower:
            names[segment.v] = body.joint.name
    M, most = (np.array(definitions.mass(Machine(x, []), q.tolist()), float) for x in (system, _spread(system)))
    if system.has_sprung_rotors:  # they need not follow
        S = np.array(definitions.rotor_coupling(machine, q.tolist()), float)
        M -= S / [d.drive.reflected_inertia or np.inf for d in machine.drives] @ S.T
    scale = np.sqrt(np.diag(most))
    scale[scale == 0.0] = 1.0
    values, vectors = np.linalg.eigh(M / np.outer(scale, scale))
    share = np.abs(vectors[:, 0])
    return list(dict.fromkeys(names[share > 0.1 * share.max()])) if values[0] < ROUNDING else []


def _spread(system: System) -> System:
    """With bodies that resist every motion of their frame, as much as theirs resist any."""
    bodies = [replace(s, inertia=_spread_inertia(s.inertia)) for s in system.segments]
    return replace(system, segments=tuple(bodies), spins=())


def _spread_inertia(inertia: Inertia) -> Inertia:
    xx, yy, zz = (row[k] for k, row in enumerate(map(tuple, inertia.rotational)))
    return Inertia(inertia.mass, ZERO, IDENTITY * (xx + yy + zz))
