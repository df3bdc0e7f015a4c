"""Functions that treat each joint independently: one kernel per kind of joint, run over all joints of the kind."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cutpoint import kernels
from cutpoint.definitions import Machine
from cutpoint.door import checked_array
from cutpoint.kernels import Kernel
from cutpoint.kernels.arrays.arguments import common_batch
from cutpoint.mechanics.system import Driven, Segment, System
from cutpoint.model.mechanism import WORLD
from cutpoint.scalars import leaves, rebuild, structure_of

MOST_STRAIGHT_BODIES = 256
"""Bodies up to which straight-line code is taken: its single calls are quicker."""

MOST_KINDS = 16

OUTPUTS = {
    "integrate": "q", "difference": "v", "coordinate_rates": "q", "drive_torque": "drive", "friction_torques": "v",
    "elastic_energy": "total",
}  # fmt: skip
"""What an output has an entry for; a total is the sum of what drives have."""


class Joint(NamedTuple):
    """A joint with its drive, if that matters, and its number among the drives."""

    segment: Segment
    driven: Driven | None
    number: int


class Kind(NamedTuple):
    """Joints that are alike: their kernel, where their entries stand (joints, own), and their drives' numbers."""

    kernel: Kernel
    places: Mapping[str, np.ndarray]
    parameters: list[np.ndarray]


def joint_by_joint(
    key: Any, definition: Callable[..., Any], sizes: Mapping[str, int | tuple[()]], machine: Machine, backend: str
) -> "JointByJoint | None":
    """A joint-by-joint function, if it allows that, and if the robot is large with mostly similar joints.

    sizes: of the inputs.  machine: without drives, if they do not matter.
    """
    if key not in OUTPUTS or len(machine.system.segments) <= MOST_STRAIGHT_BODIES:
        return None
    if OUTPUTS[key] in ("drive", "total") and not machine.drives:
        return None
    kinds = _kinds(machine)
    return JointByJoint(key, definition, sizes, machine, kinds, backend) if len(kinds) <= MOST_KINDS else None


class JointByJoint:
    """A function of one robot, for arrays (..., n) that broadcast."""

    def __init__(
        self,
        name: str,
        definition: Callable[..., Any],
        sizes: Mapping[str, int | tuple[()]],
        machine: Machine,
        kinds: Sequence[Sequence[Joint]],
        backend: str,
    ) -> None:
        self.name, self._sizes, self._output = name, sizes, OUTPUTS[name]
        system = machine.system
        self._length = {"q": system.nq, "v": system.nv}.get(self._output, len(machine.drives))
        self._kinds = [_compiled(name, definition, sizes, system, joints, backend) for joints in kinds]

    def __call__(self, *given: ArrayLike) -> Any:
        """The output (..., n).

        Raises:
            InputError: a wrong shape, or a number that is not finite.
        """
        pairs = zip(self._sizes.items(), given, strict=True)
        arrays = {key: checked_array(self.name, key, x, size) for (key, size), x in pairs}
        batches = {key: x.shape[: x.ndim - (self._sizes[key] != ())] for key, x in arrays.items()}
        batch = common_batch(self.name, batches)
        found = np.zeros((*batch, self._length))
        for kind in self._kinds:
            own = [_own(kind, key, x) for key, x in arrays.items()]
            places = kind.places[self._output]
            found[..., places] = np.reshape(kind.kernel(*own, *kind.parameters), (*found.shape[:-1], *places.shape))
        return found.sum(axis=-1) if self._output == "total" else found


def _own(kind: Kind, key: str, x: np.ndarray) -> np.ndarray:
    """The entries of these joints, (..., joints, own); what is one number for all, (..., 1)."""
    return x[..., None] if key == "dt" else x[..., kind.places[_where(key)]]


def _where(key: str) -> str:
    """What an input has an entry for."""
    return {"q_next": "q", "theta": "drive", "theta_dot": "drive"}.get(key, key)


def _kinds(machine: Machine) -> list[list[Joint]]:
    """Joints with an entry of their own, by kind of joint and structure of drive."""
    segments = machine.system.segments
    if machine.drives:
        joints = [Joint(segments[d.segment], d, k) for k, d in enumerate(machine.drives)]
    else:
        joints = [Joint(segment, None, 0) for segment in segments if not segment.follower]
    kinds: dict[Any, list[Joint]] = {}
    for joint in joints:
        key = (joint.segment.joint, structure_of(joint.driven.drive) if joint.driven else None)
        kinds.setdefault(key, []).append(joint)
    return [*kinds.values()]


def _compiled(
    name: str,
    definition: Callable[..., Any],
    sizes: Mapping[str, int | tuple[()]],
    system: System,
    joints: Sequence[Joint],
    backend: str,
) -> Kind:
    first, driven = joints[0].segment, joints[0].driven
    places = {
        "q": np.array([range(j.segment.q.start, j.segment.q.stop) for j in joints]),
        "v": np.array([range(j.segment.v.start, j.segment.v.stop) for j in joints]),
        "drive": np.array([[j.number] for j in joints]),
    }
    places["total"] = places["drive"]
    nq, nv = places["q"].shape[1], places["v"].shape[1]
    alone = replace(first, parent=WORLD, q=slice(0, nq), v=slice(0, nv))
    one = replace(system, segments=(alone,), frames={}, nq=nq, nv=nv, armature=(0,) * nv, spins=())
    numbers = np.array([leaves(j.driven.drive) if j.driven else [] for j in joints], dtype=np.float64)

    def of_one(**given: Any) -> Any:
        own = iter(given.pop("parameters", ()))
        drives = [Driven(rebuild(driven.drive, own), 0, 0, 0)] if driven else []
        return definition(Machine(one, drives), **given)

    shapes: dict[str, Any] = {key: () if key == "dt" else places[_where(key)].shape[1] for key in sizes}
    shapes |= {"parameters": numbers.shape[1]} if numbers.size else {}
    kernel = kernels.compile(of_one, name=name, backend=backend, **shapes)
    return Kind(kernel, places, [numbers] if numbers.size else [])
