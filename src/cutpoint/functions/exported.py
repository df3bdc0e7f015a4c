"""The functions of a robot that can be exported as code."""

RESULTS = {
    "inverse_dynamics": "torque", "forward_dynamics": "a", "mass_matrix": "M", "bias_forces": "torque",
    "gravity_forces": "torque", "coriolis_matrix": "C", "regressor": "Y", "jacobian": "J", "frame_pose": "pose",
    "velocity_map": "J", "kinetic_energy": "energy", "potential_energy": "energy", "momentum": "h",
    "power_flows": "power", "integrate": "q_next", "difference": "v", "coordinate_rates": "q_dot",
    "elastic_inverse_dynamics": "", "elastic_forward_dynamics": "", "elastic_energy": "energy",
    "drive_torque": "torque", "drive_regressor": "", "static_deflection": "deflection", "friction_torques": "torque",
    "inverse_dynamics_derivatives": "", "forward_dynamics_derivatives": "",
    "elastic_inverse_dynamics_derivatives": "", "elastic_forward_dynamics_derivatives": "",
}  # fmt: skip
"""How the result of each is called; those that return several name them themselves."""
