"""A robot with elastic joints, linearised: Jacobians of its equations of motion, exact to rounding."""

import numpy as np
from numpy.typing import ArrayLike

from cutpoint.analysis.linear_model import LinearModel, OperatingPoint
from cutpoint.analysis.plant import Plant, plant_of
from cutpoint.arrays import Array
from cutpoint.derivatives.sweeps import Slopes
from cutpoint.door import check_truths, checked_array
from cutpoint.errors import InputError
from cutpoint.joint_units import at_joints
from cutpoint.robot import Robot
from cutpoint.robot_arguments import check_robot, checked_pose


def linearize(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike | None = None,
    motor_torque: ArrayLike | None = None,
    *,
    friction: bool = False,
) -> LinearModel:
    """The linear model of a robot near a state, exact to rounding: see `cutpoint.derivatives`.

    By default the robot rests: v is zero, each motor leads its link by the static deflection, and motor torques
    balance gravity.  With v, positions and speeds of motors are those of a motion at constant speed.  motor_torque
    replaces the torque only.  An undriven joint (a floating base) may fall: see `LinearModel.drift`.

    friction=False leaves friction out and shows the structure: resonances and anti-resonances, damped by the springs'
    own damping only.  friction=True takes its slope at v.  At rest that is the slope of the smoothed sgn, about
    static / smoothing (N m s/rad), steep: it is valid only for speeds well below `smoothing`, where the drive creeps.
    A joint that oscillates faster has far less damping, and one that sticks is locked; a linear model represents
    neither.  Elements of hysteresis are left out, too: in small motions they stick and add their stiffness to the
    spring's.  So are the motor's ripple and cogging: torques at its shaft are the model's input.

    Args:
        q: (nq,) rad (m).  v: (nv,) rad/s (m/s).  motor_torque: (drives,) N m (N) at the joint's side.

    Raises:
        InputError: a wrong shape or number, a batch, q far beyond limits, as if in degrees, v on a joint of several
            coordinates (its tangent frame turns), or a robot that cannot move.
        ModelError: a joint can move without moving any inertia.
    """
    point, plant = _operating_point(robot, q, v, motor_torque, friction)
    slopes = plant.slopes(point.q, point.v, point.theta, point.theta_dot, point.motor_torque)
    by_direction, drift = _rates(robot, point, slopes)
    kept, C, outputs = _kept(robot), _outputs(robot), _output_names(robot)
    return LinearModel(
        A=by_direction[np.ix_(kept, kept)],
        B=by_direction[kept, len(outputs) :],
        C=C[:, kept],
        D=np.zeros((len(C), len(robot.drives))),
        drift=drift[kept],
        states=tuple(outputs[k] for k in kept),
        inputs=tuple(f"motor_torque.{name}" for name in robot.joints),
        outputs=outputs,
        joints=robot.joints,
        units=tuple(at_joints(robot, "rad").values()),
        point=point,
        friction=friction,
    )


def _operating_point(
    robot: Robot, q: ArrayLike, v: ArrayLike | None, motor_torque: ArrayLike | None, friction: bool
) -> tuple[OperatingPoint, Plant]:
    check_robot("linearize", robot)
    check_truths("linearize", friction=friction)
    if not robot.nv:
        raise InputError(f"linearize: robot {robot.name!r} has no joint that moves, so there is nothing to linearise")
    q = checked_pose("linearize", robot, q)
    v = _one("v", np.zeros(robot.nv) if v is None else v, robot.nv)
    for body, own in zip(robot.mechanism.bodies, robot.machine.system.segments, strict=True):
        if own.v.stop - own.v.start > 1 and v[own.v].any():
            what = f"linearize: v of {body.joint.kind} joint {body.joint.name!r}"
            raise InputError(f"{what} must be zero: its tangent frame would turn", joint=body.joint.name)
    plant = plant_of(robot, friction)
    steady = plant.steady(q, v)
    torque = steady.motor_torque
    if motor_torque is not None:
        torque = _one("motor_torque", motor_torque, len(robot.drives))
    return OperatingPoint(q, v, steady.theta, steady.theta_dot, torque), plant


def _one(name: str, value: ArrayLike, size: int) -> Array:
    array = checked_array("linearize", name, value, size)
    if array.ndim != 1:
        raise InputError(
            f"linearize: {name} has shape {array.shape}; give a single operating point, ({size},)", name=name
        )
    return array


def _rates(robot: Robot, point: OperatingPoint, found: Slopes) -> tuple[Array, Array]:
    """x' with all motors, rigid drives' included: for each direction of (x, motor torques), and at the point itself."""
    nv, drives = robot.nv, len(robot.drives)
    directions = np.eye(2 * nv + 3 * drives)
    v, theta_dot = directions[nv : 2 * nv], directions[2 * nv + drives : 2 * (nv + drives)]
    by_direction = np.vstack([v, found.slope[:nv], theta_dot, found.slope[nv:]])
    return by_direction, np.concatenate([point.v, found.value[:nv], point.theta_dot, found.value[nv:]])


def _kept(robot: Robot) -> list[int]:
    """Which of (q, v, theta, theta_dot) are states: a rigid drive's motor has no state."""
    elastic = np.array([d.is_elastic for d in robot.drives.values()], bool)
    return np.flatnonzero(np.r_[np.ones(2 * robot.nv, bool), elastic, elastic]).tolist()


def _outputs(robot: Robot) -> Array:
    """Maps (q, v, theta, theta_dot) without rigid drives' motors to the same with all motors."""
    nv, drives = robot.nv, len(robot.drives)
    C = np.eye(2 * nv + 2 * drives)
    for k, driven in enumerate(robot.machine.drives):
        if not driven.drive.is_elastic:
            C[2 * nv + k, driven.v] = C[2 * nv + drives + k, nv + driven.v] = 1.0
    return C


def _output_names(robot: Robot) -> tuple[str, ...]:
    links = _coordinate_names(robot)
    parts = {"q": links, "v": links, "theta": robot.joints, "theta_dot": robot.joints}
    return tuple(f"{part}.{name}" for part, names in parts.items() for name in names)


def _coordinate_names(robot: Robot) -> list[str]:
    """A name for each speed: its joint's, with an index if the joint has several."""
    names = [""] * robot.nv
    for body, own in zip(robot.mechanism.bodies, robot.machine.system.segments, strict=True):
        count = own.v.stop - own.v.start
        if not own.follower:
            names[own.v] = [body.joint.name] if count == 1 else [f"{body.joint.name}[{k}]" for k in range(count)]
    return names
