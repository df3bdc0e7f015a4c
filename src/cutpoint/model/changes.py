"""Modified robots: with a payload, or mounted elsewhere."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.errors import ModelError, unknown_name
from cutpoint.model.lumping import MassProperties, lumped, placed
from cutpoint.model.mechanism import WORLD, Body, Frame, Link, Mechanism
from cutpoint.model.places import Places
from cutpoint.model.pose import is_rigid
from cutpoint.model.validation import LARGEST_NUMBER, any_array, check_link, fault_of


def with_payload(mechanism: Mechanism, mass: float, com: ArrayLike, inertia: ArrayLike, frame: str) -> Mechanism:
    """The robot with a payload fixed to a frame: mass (kg), com (3,) (m), inertia about it (3, 3) (kg m2) there."""
    if not isinstance(frame, str) or frame not in mechanism.frames:
        raise unknown_name("frame", frame, mechanism.frames)
    place, nowhere = mechanism.frames[frame], Places(None)
    link = Link("payload", mass, any_array(com), any_array(inertia))
    check_link(link, nowhere)
    if place.body == WORLD:
        raise ModelError(f"payload: frame {frame!r} is fixed to the world; name a frame that moves", frame=frame)
    piece = placed(place.placement, MassProperties(float(mass), link.com, link.inertia))
    carrier = mechanism.bodies[place.body]
    whole = lumped(MassProperties(carrier.mass, carrier.com, carrier.inertia), piece)
    body = replace(carrier, mass=whole.mass, com=whole.com, inertia=whole.inertia)
    if fault := fault_of(body):
        told = f"payload: with it link {carrier.name!r} has {fault.moments}: {fault.rule}; check its inertia (3, 3)"
        raise ModelError(told, link=carrier.name, inertia=body.inertia)
    return _with_body(mechanism, place.body, body)


def with_base(mechanism: Mechanism, placement: ArrayLike) -> Mechanism:
    """The robot mounted elsewhere: placement (4, 4) of its base in the world."""
    matrix = any_array(placement)
    are_numbers = (
        matrix.shape == (4, 4) and matrix.dtype.kind in "fiu" and bool((np.abs(matrix) <= LARGEST_NUMBER).all())
    )
    if not are_numbers or not is_rigid(matrix):
        found = f"shape {matrix.shape}" if matrix.shape != (4, 4) else f"{matrix.tolist()}"
        rule = "must be (4, 4), a proper rotation and a translation"
        raise ModelError(f"base: placement {rule}, got {found}", placement=matrix)
    moved = [replace(b, placement=matrix @ b.placement) if b.parent == WORLD else b for b in mechanism.bodies]
    frames = {
        name: Frame(name, WORLD, matrix @ f.placement) if f.body == WORLD and name != "world" else f
        for name, f in mechanism.frames.items()
    }
    return replace(mechanism, bodies=tuple(moved), frames=frames)


def _with_body(mechanism: Mechanism, index: int, body: Body) -> Mechanism:
    bodies = [*mechanism.bodies]
    bodies[index] = body
    return replace(mechanism, bodies=tuple(bodies))
