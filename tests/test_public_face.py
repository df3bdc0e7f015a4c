"""The public face: a change to it must be meant, so it shows here."""

import re
from pathlib import Path

import cutpoint

PACKAGE = """
    Backlash CatalogueSpring Coulomb CutpointError Drive ElastoPlastic Flexspline Grease Harmonic HarmonicSpring
    InputError Kernel KinematicError Limits LinearSpring Log LuGre MaxwellSlip ModelError Motor Ratings Robot Rotor
    Sensors SimulationError Sliding State Stribeck TraceError WaveGenerator absolute acos analysis asin atan atan2
    clip compile control cos derivatives exp export formats identification load log maximum minimum robots simulate
    simulate_many simulation sin sqrt tan tanh trajectories where
"""

ROBOT = """
    bias_forces coordinate_rates coriolis_matrix cuts derivatives_needed difference drive_coefficients
    drive_parameters drive_regressor drive_torque elastic_energy elastic_forward_dynamics elastic_inverse_dynamics
    forward_dynamics frame_pose frames friction_torques from_rotor gravity gravity_forces inertial_parameters
    integrate inverse_dynamics jacobian joints kernel kinetic_energy linearize machine machine_with mass_matrix
    modes momentum name neutral nq nv potential_energy power_flows random regressor static_deflection strain_names
    subsystems to_rotor trace_key velocity_map with_base with_drives with_gravity with_payload
"""

CONTROL = """
    AdaptiveVDC Command ComputedTorque Controller DisturbanceObserver ElasticComputedTorque Fault Feedforward
    FullStateFeedback GravityCompensation Guard Law Margins Measurement PD PID Reference Robust SampledPole SlotineLi
    SpeedFilter Sum SuperTwisting VDC margins slowest_pole tune
"""

TRAJECTORIES = """
    Sample Trajectory cycloid from_csv from_samples quintic septic waypoints
"""


def test_the_package_offers_these_names():
    assert sorted(cutpoint.__all__) == PACKAGE.split()


def test_a_robot_offers_these_names():
    assert sorted(name for name in vars(cutpoint.Robot) if not name.startswith("_")) == ROBOT.split()


def test_laws_and_trajectories_are_these():
    assert sorted(cutpoint.control.__all__) == CONTROL.split()
    assert sorted(cutpoint.trajectories.__all__) == TRAJECTORIES.split()


def test_the_guide_knows_all_that_a_robot_offers():
    guide = (Path(__file__).parents[1] / "docs/guide.md").read_text("utf-8")
    assert not [name for name in ROBOT.split() if not re.search(rf"\b{name}\b", guide)]


def test_everything_public_says_what_it_is():
    assert not [name for name in ROBOT.split() if not getattr(cutpoint.Robot, name).__doc__]
