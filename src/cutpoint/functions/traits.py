"""What the functions of a robot are like: all that can be exported, by name."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple


class Traits(NamedTuple):
    """What compiling and exporting a function need to know of it, beside its definition.

    result: how its result is called in exported code; "" where several name themselves.
    lean: the lean machine gives the same in fewer operations.
    ignores_rotors: no drive has a part in it, whatever links feel of rotors.
    divides: by inertia, which no joint may lack.
    is_matrix: its results have a row or column for each speed, and so none if nothing moves.
    """

    result: str = ""
    lean: bool = False
    ignores_rotors: bool = False
    divides: bool = False
    is_matrix: bool = False


TRAITS: Mapping[str, Traits] = MappingProxyType({
    "inverse_dynamics": Traits("torque", lean=True),
    "forward_dynamics": Traits("a", lean=True, divides=True),
    "mass_matrix": Traits("M", lean=True, is_matrix=True),
    "bias_forces": Traits("torque", lean=True),
    "gravity_forces": Traits("torque", lean=True),
    "coriolis_matrix": Traits("C", lean=True, is_matrix=True),
    "regressor": Traits("Y", is_matrix=True),
    "jacobian": Traits("J", ignores_rotors=True),
    "frame_pose": Traits("pose", ignores_rotors=True),
    "velocity_map": Traits("J", ignores_rotors=True, is_matrix=True),
    "kinetic_energy": Traits("energy", lean=True),
    "potential_energy": Traits("energy", lean=True),
    "momentum": Traits("h"),
    "power_flows": Traits("power"),
    "integrate": Traits("q_next", ignores_rotors=True),
    "difference": Traits("v", ignores_rotors=True),
    "coordinate_rates": Traits("q_dot", ignores_rotors=True),
    "elastic_inverse_dynamics": Traits(lean=True),
    "elastic_forward_dynamics": Traits(lean=True, divides=True),
    "elastic_energy": Traits("energy"),
    "drive_torque": Traits("torque"),
    "drive_regressor": Traits(lean=True, is_matrix=True),
    "static_deflection": Traits("deflection", lean=True),
    "friction_torques": Traits("torque"),
    "inverse_dynamics_derivatives": Traits(lean=True, is_matrix=True),
    "forward_dynamics_derivatives": Traits(lean=True, divides=True, is_matrix=True),
    "elastic_inverse_dynamics_derivatives": Traits(lean=True, is_matrix=True),
    "elastic_forward_dynamics_derivatives": Traits(lean=True, divides=True, is_matrix=True),
})  # fmt: skip


def traits_of(name: str) -> Traits:
    """Those of a function by name; of one that is not exported, none."""
    return TRAITS.get(name, Traits())
