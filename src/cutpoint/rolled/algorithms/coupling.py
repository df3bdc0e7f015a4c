"""Rotors with full coupling behind springs, as passes beside those of rigid bodies: see the mechanics' `rotors`."""

from typing import Any

from cutpoint.kernels import Stage
from cutpoint.mechanics import forward_dynamics
from cutpoint.mechanics.bodies.spatial import Vec3
from cutpoint.rolled.bodies import Columns
from cutpoint.rolled.drives import Model
from cutpoint.rolled.packing import motion_of, packed_resistance, pose_by_columns, resistance_of, wrench_of
from cutpoint.rolled.passes import Order, Pass


def carried(columns: Columns, order: Order, rates: tuple[str, ...]) -> Pass:
    """Wrench on its carrier of a rotor that moves with its joint, as if its drive were rigid."""

    def reacts(row: Any, carrier: Any, borne: Any, *given: Any) -> Any:
        own, omega = columns.subsystem(row), Vec3(*order.scalars(carrier)[:3])
        (speed,), (acceleration,) = (order.rate(given, k) for k in (0, 1))
        assert own.behind is not None
        return order.packed(wrench_of(order.scalars(borne)) + own.behind.reaction(omega, speed, acceleration))

    return Pass("inward", Stage(reacts, ("body", "carrier", "borne", *rates), ("borne",)))


def pushed(columns: Columns, order: Order) -> Pass:
    """The additional torque of the motor due to its carrier's rotation."""

    def pushes(row: Any, carrier: Any, motor_torque: Any) -> Any:
        own, A = columns.subsystem(row), motion_of(order.scalars(carrier)[3:])
        assert own.behind is not None
        (first, *_) = order.packed([own.behind.along(A.angular)])
        return [motor_torque[0] + first]

    return Pass("outward", Stage(pushes, ("body", "carrier", "motor_torque"), ("motor_torque",)))


def with_free_rotor(columns: Columns) -> Pass:
    """Wrench on its carrier due to the spin of a rotor, which does not follow the carrier about its axis."""

    def spins(row: Any, turned: Any, omega: Any, carried: Any, speed: Any, alpha: Any, handed: Any) -> Any:
        own, A = columns.subsystem(row).along_the_world(pose_by_columns(turned)).behind, motion_of(carried)
        assert own is not None
        M, P = resistance_of(handed)
        spun = forward_dynamics.with_free_rotor(own, own.inertia, M, P, Vec3(*omega), A, speed[0], alpha[0])
        return packed_resistance(*spun)

    reads = ("body", "turned", "carrier", "carried", "theta_dot", "theta_ddot", "handed")
    return Pass("inward", Stage(spins, reads, ("handed",)))


def left_behind(columns: Columns) -> Pass:
    """Subtracts the carrier's rotation from the acceleration of such a rotor."""

    def lags(row: Any, turned: Any, coasting: Any, added: Any, theta_ddot: Any) -> Any:
        own, A = columns.subsystem(row).along_the_world(pose_by_columns(turned)).behind, motion_of(coasting)
        assert own is not None
        turn = own.axis.dot((A + motion_of(added)).angular)

        def own_turn(drive: Model) -> list[Any]:
            if drive is None or not (drive.is_elastic and drive.is_coupled):
                return [theta_ddot[0]]
            return [theta_ddot[0] - turn / drive.ratio]

        return columns.by_drive(row, own_turn)

    return Pass("outward", Stage(lags, ("body", "turned", "carried", "led", "theta_ddot"), ("theta_ddot",)))
