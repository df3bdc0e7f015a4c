"""Functions of a robot in their most common form: by name only, without variants."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple
from weakref import WeakMethod

from cutpoint import definitions
from cutpoint.mechanics.drive_regressor import DriveRegressor
from cutpoint.mechanics.elastic_forward import ElasticAccelerations
from cutpoint.mechanics.elastic_inverse import ElasticTorques

Function = Callable[..., Any]


class Plain(NamedTuple):
    """Arguments of `RobotKernels.function` for a function, apart from its name."""

    definition: Function
    inputs: str
    reads_drives: bool = False
    record: type[tuple[Any, ...]] | None = None


PLAIN: Mapping[str, Plain] = MappingProxyType({
    "inverse_dynamics": Plain(definitions.inverse_dynamics, "q v a"),
    "forward_dynamics": Plain(definitions.forward_dynamics, "q v tau"),
    "mass_matrix": Plain(definitions.mass_matrix, "q"),
    "bias_forces": Plain(definitions.bias_forces, "q v"),
    "gravity_forces": Plain(definitions.gravity_forces, "q"),
    "coriolis_matrix": Plain(definitions.coriolis_matrix, "q v"),
    "regressor": Plain(definitions.regressor, "q v a"),
    "velocity_map": Plain(definitions.velocity_map, "q"),
    "kinetic_energy": Plain(definitions.kinetic_energy, "q v"),
    "potential_energy": Plain(definitions.potential_energy, "q"),
    "momentum": Plain(definitions.momentum, "q v"),
    "power_flows": Plain(definitions.power_flows, "q v a"),
    "integrate": Plain(definitions.integrate, "q v dt"),
    "difference": Plain(definitions.difference, "q q_next"),
    "coordinate_rates": Plain(definitions.coordinate_rates, "q v"),
    "elastic_inverse_dynamics": Plain(
        definitions.elastic_inverse_dynamics, "q v a jerk snap", True, ElasticTorques
    ),
    "elastic_forward_dynamics": Plain(
        definitions.elastic_forward_dynamics, "q v theta theta_dot motor_torque", True, ElasticAccelerations
    ),
    "elastic_energy": Plain(definitions.elastic_energy, "q theta theta_dot", True),
    "drive_torque": Plain(definitions.drive_torque, "theta q", True),
    "static_deflection": Plain(definitions.static_deflection, "q", True),
    "friction_torques": Plain(definitions.friction_torques, "v", True),
    "drive_regressor": Plain(definitions.drive_regressor, "q v theta theta_dot theta_ddot", True, DriveRegressor),
})  # fmt: skip


class Functions(dict[Any, Function]):
    """Compiled functions, by name or by a tuple that begins with it; plain ones are made at their first use."""

    def __init__(self, make: Function) -> None:
        """make: a method that makes the function of a name and a `Plain`, and puts it here."""
        super().__init__()
        self._make = WeakMethod(make)  # weak, since its object holds these: code is freed with the robot

    def __missing__(self, name: str) -> Function:
        make = self._make()
        assert make is not None, "a robot holds what makes its functions"
        return make(name, *PLAIN[name])
