"""What the functions of a robot are like: all that can be exported, by name."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from cutpoint import definitions
from cutpoint.mechanics.drive_regressor import DriveRegressor
from cutpoint.mechanics.elastic_forward import ElasticAccelerations
from cutpoint.mechanics.elastic_inverse import ElasticTorques


class Facts(NamedTuple):
    """What compiling, calling and exporting a function need to know of it.

    inputs: their names in order, separated by spaces.
    definition: on a Machine and lists of scalars; None where it depends on what is asked, such as a frame.
    result: how its result is called in exported code; "" where several name themselves.
    reads_drives: whether the definition needs the drives.
    record: the NamedTuple that holds the outputs.
    lean: the lean machine gives the same in fewer operations.
    ignores_rotors: no drive has a part in it, whatever links feel of rotors.
    divides: by inertia, which no joint may lack.
    is_matrix: its results have a row or column for each speed, and so none if nothing moves.
    """

    inputs: str
    definition: Callable[..., Any] | None = None
    result: str = ""
    reads_drives: bool = False
    record: type[tuple[Any, ...]] | None = None
    lean: bool = False
    ignores_rotors: bool = False
    divides: bool = False
    is_matrix: bool = False


FACTS: Mapping[str, Facts] = MappingProxyType({
    "inverse_dynamics": Facts("q v a", definitions.inverse_dynamics, "torque", lean=True),
    "forward_dynamics": Facts("q v tau", definitions.forward_dynamics, "a", lean=True, divides=True),
    "mass_matrix": Facts("q", definitions.mass_matrix, "M", lean=True, is_matrix=True),
    "bias_forces": Facts("q v", definitions.bias_forces, "torque", lean=True),
    "gravity_forces": Facts("q", definitions.gravity_forces, "torque", lean=True),
    "coriolis_matrix": Facts("q v", definitions.coriolis_matrix, "C", lean=True, is_matrix=True),
    "regressor": Facts("q v a", definitions.regressor, "Y", is_matrix=True),
    "jacobian": Facts("q", result="J", ignores_rotors=True),
    "frame_acceleration": Facts("q v a", result="acceleration", ignores_rotors=True),
    "frame_pose": Facts("q", result="pose", ignores_rotors=True),
    "velocity_map": Facts("q", definitions.velocity_map, "J", ignores_rotors=True, is_matrix=True),
    "kinetic_energy": Facts("q v", definitions.kinetic_energy, "energy", lean=True),
    "potential_energy": Facts("q", definitions.potential_energy, "energy", lean=True),
    "momentum": Facts("q v", definitions.momentum, "h"),
    "power_flows": Facts("q v a", definitions.power_flows, "power"),
    "integrate": Facts("q v dt", definitions.integrate, "q_next", ignores_rotors=True),
    "difference": Facts("q q_next", definitions.difference, "v", ignores_rotors=True),
    "coordinate_rates": Facts("q v", definitions.coordinate_rates, "q_dot", ignores_rotors=True),
    "elastic_inverse_dynamics": Facts(
        "q v a jerk snap", definitions.elastic_inverse_dynamics, reads_drives=True, record=ElasticTorques, lean=True,
    ),
    "elastic_forward_dynamics": Facts(
        "q v theta theta_dot motor_torque", definitions.elastic_forward_dynamics, reads_drives=True,
        record=ElasticAccelerations, lean=True, divides=True,
    ),
    "elastic_energy": Facts("q theta theta_dot", definitions.elastic_energy, "energy", reads_drives=True),
    "drive_torque": Facts("theta q", definitions.drive_torque, "torque", reads_drives=True),
    "drive_regressor": Facts(
        "q v theta theta_dot theta_ddot", definitions.drive_regressor, reads_drives=True,
        record=DriveRegressor, lean=True, is_matrix=True,
    ),
    "static_deflection": Facts("q", definitions.static_deflection, "deflection", reads_drives=True, lean=True),
    "friction_torques": Facts("v", definitions.friction_torques, "torque", reads_drives=True),
    "inverse_dynamics_derivatives": Facts("q v a", lean=True, is_matrix=True),
    "forward_dynamics_derivatives": Facts("q v tau", lean=True, divides=True, is_matrix=True),
    "elastic_inverse_dynamics_derivatives": Facts("q v a jerk snap", reads_drives=True, lean=True, is_matrix=True),
    "elastic_forward_dynamics_derivatives": Facts(
        "q v theta theta_dot motor_torque", reads_drives=True, lean=True, divides=True, is_matrix=True,
    ),
})  # fmt: skip
