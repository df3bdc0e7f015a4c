"""The combinations of a robot's inertial parameters that motion identifies.  Gautier (1991), J. Robotic Systems 8(4).

Torques are linear in ten parameters per body, but most of these act only in combination.  A QR of the regressor of
random motions with column pivoting counts the combinations that act on their own; a second one, in an order of
preference, chooses the parameters that stand for them.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import qr

from cutpoint.arrays import Array
from cutpoint.door import checked_name, checked_names
from cutpoint.errors import InputError
from cutpoint.identification.one_thread import by_one_thread
from cutpoint.model.mechanism import Body
from cutpoint.robot import Robot
from cutpoint.robot_arguments import check_robot

Indices = NDArray[np.intp]

SYMBOLS = ("m", "h_x", "h_y", "h_z", "I_xx", "I_xy", "I_xz", "I_yy", "I_yz", "I_zz")
"""Mass, first moment and inertia about the frame's origin of a body: the order of `Robot.inertial_parameters`."""

TOLERANCE = 1e-5
"""Share of a dependent column's length that the others may leave unexplained.  Robot files round angles: what axes that
are parallel but for rounding would reveal, no log shows."""

ROUNDED_SHARE = 1e-6
"""Share of a column's length below which it is such rounding, and is set to zero."""

ROWS = 4
"""Rows of the regressor of random motions for each of its columns."""


@dataclass(frozen=True, eq=False)
class BaseParameters:
    """The combinations of a robot's parameters p that its torques determine: base = matrix @ p.

    parameters: names of p, (p,), as "I_zz.link3"; inertias of rotors at the joints follow, as "I_m.joint3".
    independent: indices (b,) of the parameters that stand for the combinations; their columns of the regressor,
    times the base parameters, give the torques.  matrix: (b, p).  unidentifiable: names of parameters without effect.
    rotors: indices of the joints with rotors included.
    """

    parameters: tuple[str, ...]
    independent: Indices
    matrix: Array = field(repr=False)
    robot: Robot = field(repr=False)
    rotors: tuple[int, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """The combinations (b,) in readable form, as "I_zz.link3 + 0.3 h_x.link4", with four-digit coefficients."""
        return tuple(self._name(row, k) for row, k in zip(self.matrix, self.independent, strict=True))

    @property
    def unidentifiable(self) -> tuple[str, ...]:
        """Names of the parameters that no torque depends on."""
        used = np.abs(self.matrix).sum(axis=0) > 0.0
        return tuple(name for name, seen in zip(self.parameters, used, strict=True) if not seen)

    @property
    def nominal(self) -> Array:
        """The base parameters (b,) of the robot's own inertias; a missing rotor counts as none."""
        reflected = [self.robot.drives[self.robot.joints[j]].reflected_inertia for j in self.rotors]
        return self.matrix @ np.array([*self.robot.inertial_parameters, *reflected], dtype=np.float64)

    def regressor(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Array:
        """(..., nv, b): joint torques of a motion are regressor @ base parameters.

        Raises InputError as `Robot.regressor` does.
        """
        return _regressor(self.robot, q, v, a, self.rotors)[..., self.independent]

    def _name(self, row: Array, own: int) -> str:
        order = [own, *(k for k in np.flatnonzero(row) if k != own)]
        return " ".join(_term(float(row[k]), self.parameters[k], first=k == own) for k in order)


@by_one_thread
def base_parameters(robot: Robot, *, rotors: bool | Collection[str] = False) -> BaseParameters:
    """The base parameters of a robot under its gravity, rigidly connected bodies counting as one.

    rotors: include the reflected inertia of every drive's rotor, or of these joints' (ratio^2 times its own, as an
    armature), as one more parameter each; for an elastic drive this assumes that the motor moves as its joint does.
    The random motions are seeded, so the result is reproducible.

    Raises InputError for a robot without a joint, or a joint that it does not have.
    """
    check_robot("base_parameters", robot)
    if not robot.nv:
        raise InputError(f"robot {robot.name!r} has no joint that moves: no torque tells its parameters")
    counted = _counted(robot, rotors)
    W = _observed(robot, counted)
    length = np.linalg.norm(W, axis=0)
    felt = length > TOLERANCE * length.max()
    scaled = np.where(felt, W, 0.0) / np.where(felt, length, 1.0)
    kept = _independent(scaled, _preferred(robot, W.shape[1]))
    share = np.linalg.lstsq(scaled[:, kept], scaled, rcond=None)[0]
    share[np.abs(share) < ROUNDED_SHARE] = 0.0
    share[:, kept] = np.eye(len(kept))
    matrix = share * np.where(felt, length, 0.0) / length[kept, None]
    return BaseParameters(_names(robot, counted), kept, matrix, robot, counted)


def rotor_sizes(base: BaseParameters) -> tuple[Array, NDArray[np.bool_]]:
    """Sizes of the included rotors, kg m2 at the joint, and whether they are the file's, or else the arm's."""
    robot, counted = base.robot, [*base.rotors]
    reflected = np.array([float(drive.reflected_inertia) for drive in robot.drives.values()])[counted]
    arm = np.diag(robot.mass_matrix(robot.neutral()))[counted]
    return np.where(reflected > 0.0, reflected, np.maximum(arm, np.finfo(float).tiny)), reflected > 0.0


def _counted(robot: Robot, rotors: bool | Collection[str]) -> tuple[int, ...]:
    """Indices of the joints with rotors included."""
    if isinstance(rotors, bool):
        return tuple(range(len(robot.joints))) if rotors else ()
    rotors = checked_names("base_parameters", rotors, "rotors", "True, False, or names of joints")
    for joint in rotors:
        checked_name("driven joint", joint, robot.joints)
    return tuple(j for j, joint in enumerate(robot.joints) if joint in rotors)


def _observed(robot: Robot, rotors: Sequence[int]) -> Array:
    """The regressor of random motions, stacked: (rows, p)."""
    rng = np.random.default_rng(0)
    columns = 10 * len(robot.mechanism.bodies) + len(rotors)
    count = -(-ROWS * columns // robot.nv)
    v, a = rng.standard_normal((2, count, robot.nv))
    return _regressor(robot, robot.random(rng, count), v, a, rotors).reshape(-1, columns)


def _independent(W: Array, preferred: Indices) -> Indices:
    """Indices of a maximal set of independent columns, preferred ones first; sorted."""
    revealed = np.abs(np.diag(qr(W, mode="r", pivoting=True)[0]))
    rank = int((revealed > TOLERANCE * revealed[0]).sum())
    # without pivoting, the diagonal is each column's distance from the span of those before it
    new = np.abs(np.diag(qr(W[:, preferred], mode="r")[0]))
    return np.sort(preferred[np.argsort(-new, kind="stable")[:rank]]) if rank else preferred[:0]


def _preferred(robot: Robot, columns: int) -> Indices:
    """First parameters that rotation about the joint's axis shows, then rotors, last those that the parent can absorb.

    For a revolute joint's body these last are its mass, its moment along the axis, and one inertia across it: Khalil
    and Dombre (2002), Modeling, Identification and Control of Robots, section 9.4.
    """
    bodies = robot.mechanism.bodies
    last = {10 * i + k for i, body in enumerate(bodies) for k in _taken_on(body)}
    rotors = range(10 * len(bodies), columns)
    first = [k for k in range(10 * len(bodies)) if k not in last]
    return np.array([*first, *rotors, *sorted(last)], dtype=np.intp)


def _taken_on(body: Body) -> Sequence[int]:
    along = int(np.abs(body.joint.axis).argmax())
    diagonal = (4, 7, 9)
    return 0, 1 + along, diagonal[(along + 2) % 3]


def _regressor(robot: Robot, q: ArrayLike, v: ArrayLike, a: ArrayLike, rotors: Sequence[int]) -> Array:
    Y = robot.regressor(q, v, a)
    armatures = np.zeros((*Y.shape[:-1], len(rotors)))
    for k, joint in enumerate(rotors):
        at = robot.machine.drives[joint].v
        armatures[..., at, k] = np.asarray(a, float)[..., at]
    return np.concatenate([Y, armatures], axis=-1)


def _names(robot: Robot, rotors: Sequence[int]) -> tuple[str, ...]:
    bodies = [f"{symbol}.{body.name}" for body in robot.mechanism.bodies for symbol in SYMBOLS]
    return (*bodies, *(f"I_m.{robot.joints[j]}" for j in rotors))


def _term(coefficient: float, name: str, first: bool) -> str:
    size = f"{abs(coefficient):.4g}"
    term = name if size == "1" else f"{size} {name}"
    if first:
        return term
    return f"{'-' if coefficient < 0 else '+'} {term}"
