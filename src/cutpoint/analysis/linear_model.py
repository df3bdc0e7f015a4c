"""A robot linearised at one state: four matrices with named states, inputs and outputs."""

from dataclasses import dataclass

from cutpoint.arrays import Array


@dataclass(frozen=True, eq=False)
class OperatingPoint:
    """Where a robot is linearised: q (nq,), v (nv,), and theta, theta_dot, motor_torque (drives,); SI, joint's side."""

    q: Array
    v: Array
    theta: Array
    theta_dot: Array
    motor_torque: Array


@dataclass(frozen=True, eq=False)
class LinearModel:
    """x' = A x + B u + drift, y = C x + D u, in deviations x, u, y from an operating point.

    States (N = 2 nv + 2 elastic drives): q and v of the links, theta and theta_dot of the elastic drives' motors; a
    rigid drive's motor moves with its link and has no state.  Inputs: motor torques, one a drive.  Outputs: q and v of
    all links, theta and theta_dot of all motors.  rad, rad/s, N m at the joint's side; m, m/s, N on prismatic joints.

    States that belong to q are tangent coordinates, nv of them, of the configuration
    `robot.integrate(point.q, x[:nv], 1)`.  On a joint with one coordinate this is q - point.q.

    Attributes:
        A, B, C, D: (N, N), (N, drives), (2 nv + 2 drives, N), (2 nv + 2 drives, drives).
        drift: (N,), x' at the operating point itself; zero where that is an equilibrium.
        states, inputs, outputs: names such as "theta_dot.joint2"; "q.base[3]" for one of a joint's several.
        joints, units: names of the driven joints, and the unit of their positions, "rad" or "m".
        point: the operating point.
        friction: whether friction's slope is in A.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    drift: Array
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    joints: tuple[str, ...]
    units: tuple[str, ...]
    point: OperatingPoint
    friction: bool

    def __repr__(self) -> str:
        return f"<LinearModel: {len(self.states)} states, {len(self.inputs)} inputs, {len(self.outputs)} outputs>"
