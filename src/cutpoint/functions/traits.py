"""What the functions of a robot are like: all that can be exported, by name."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple


class Traits(NamedTuple):
    """What compiling and exporting a function need to know of it, beside its definition.

    result: how its result is called in exported code; "" where several name themselves.
    of_joints: it tells nothing of single bodies, so that the lean machine gives the same in fewer operations.
    of_places: no drive has a part in it, whatever links feel of rotors.
    divides: by inertia, which no joint may lack.
    is_matrix: its results have a row or column for each speed, and so none if nothing moves.
    """

    result: str = ""
    of_joints: bool = False
    of_places: bool = False
    divides: bool = False
    is_matrix: bool = False


TRAITS: Mapping[str, Traits] = MappingProxyType({
    "inverse_dynamics": Traits("torque", of_joints=True),
    "forward_dynamics": Traits("a", of_joints=True, divides=True),
    "mass_matrix": Traits("M", of_joints=True, is_matrix=True),
    "bias_forces": Traits("torque", of_joints=True),
    "gravity_forces": Traits("torque", of_joints=True),
    "coriolis_matrix": Traits("C", of_joints=True, is_matrix=True),
    "regressor": Traits("Y", is_matrix=True),
    "jacobian": Traits("J", of_places=True),
    "frame_pose": Traits("pose", of_places=True),
    "velocity_map": Traits("J", of_places=True, is_matrix=True),
    "kinetic_energy": Traits("energy", of_joints=True),
    "potential_energy": Traits("energy", of_joints=True),
    "momentum": Traits("h"),
    "power_flows": Traits("power"),
    "integrate": Traits("q_next", of_places=True),
    "difference": Traits("v", of_places=True),
    "coordinate_rates": Traits("q_dot", of_places=True),
    "elastic_inverse_dynamics": Traits(of_joints=True),
    "elastic_forward_dynamics": Traits(of_joints=True, divides=True),
    "elastic_energy": Traits("energy"),
    "drive_torque": Traits("torque"),
    "drive_regressor": Traits(of_joints=True, is_matrix=True),
    "static_deflection": Traits("deflection", of_joints=True),
    "friction_torques": Traits("torque"),
    "inverse_dynamics_derivatives": Traits(of_joints=True, is_matrix=True),
    "forward_dynamics_derivatives": Traits(of_joints=True, divides=True, is_matrix=True),
    "elastic_inverse_dynamics_derivatives": Traits(of_joints=True, is_matrix=True),
    "elastic_forward_dynamics_derivatives": Traits(of_joints=True, divides=True, is_matrix=True),
})  # fmt: skip


def traits_of(name: str) -> Traits:
    """Those of a function by name; of one that is not exported, none."""
    return TRAITS.get(name, Traits())
