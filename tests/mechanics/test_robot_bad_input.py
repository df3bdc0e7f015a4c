"""Input that a robot's public interface refuses: each with one error that names thing, value and rule."""

from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest

from cutpoint import (
    CatalogueSpring,
    Coulomb,
    Drive,
    ElastoPlastic,
    Flexspline,
    Harmonic,
    InputError,
    KinematicError,
    Limits,
    LinearSpring,
    LuGre,
    MaxwellSlip,
    ModelError,
    Motor,
    Ratings,
    Robot,
    Rotor,
    Stribeck,
)
from cutpoint.mechanics.drives.backlash import Backlash
from cutpoint.mechanics.drives.friction import Grease
from cutpoint.mechanics.drives.wave_generator import HarmonicSpring, WaveGenerator
from robot_library import BACKENDS, robot

Q = np.zeros(6)
NAN = np.array([0.0, 0.0, 0.0, np.nan, 0.0, 0.0])
DRY, WAVE = Coulomb(1.0, 0.5, 0.1), Harmonic(6, 0.6)


class HalfASpring:
    """A law of the user's own that is not complete."""

    def torque(self, deflection: Any) -> Any:
        return deflection

    def tangent(self, deflection: Any) -> Any:
        return 1 + 0 * deflection

    def __repr__(self) -> str:
        return "a spring"


def elastic(**parts: Any) -> Drive:
    return Drive(**{"ratio": 100.0, "rotor": Rotor(1e-5), "compliance": LinearSpring(1e4), **parts})


def waved(**numbers: float) -> Drive:
    wave = replace(WaveGenerator(60.0, 2.0, 100.0, 0.02), **numbers)
    return elastic(compliance=HarmonicSpring(Flexspline(16e3, 0.05), wave))


def erring(*waves: Harmonic) -> Drive:
    return elastic(kinematic_error=KinematicError(waves))


def slipping(stiffness: Any, reach: Any) -> Drive:
    return elastic(hysteresis=MaxwellSlip(stiffness, reach))


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda r: r.inverse_dynamics(NAN, Q, Q), r"inverse_dynamics: q\[3\] is nan: every number must be finite"),
        (lambda r: r.inverse_dynamics(Q, Q, [[0] * 6, [np.inf] * 6]), r"inverse_dynamics: a\[1, 0\] is inf"),
        (lambda r: r.mass_matrix(Q + 1e16), r"mass_matrix: q\[0\] is 1e\+16: every number must be .* within 1e\+15"),
        (lambda r: r.mass_matrix([Q, Q - 1e16]), r"mass_matrix: q\[1, 0\] is -1e\+16: every number must be finite and"),
        (lambda r: r.mass_matrix(Q[:5]), r"mass_matrix: q has shape \(5,\): its last axis must be 6"),
        (lambda r: r.mass_matrix(0.0), r"mass_matrix: q has shape \(\): its last axis must be 6"),
        (lambda r: r.mass_matrix(np.zeros((6, 1))), r"q has shape \(6, 1\): its last axis must be 6"),
        (lambda r: r.mass_matrix("straight"), r"mass_matrix: q must be numbers of shape \(\.\.\., 6\)"),
        (lambda r: r.mass_matrix([[0.0] * 6, [0.0] * 5]), r"mass_matrix: q must be numbers of shape"),
        (lambda r: r.mass_matrix(Q * 1j), "mass_matrix: q must be numbers"),
        (lambda r: r.inverse_dynamics([Q] * 2, [Q] * 3, Q), r"leading axes do not broadcast: q \(2,\), v \(3,\)"),
        (lambda r: r.jacobian(Q, "toe"), "no frame is named 'toe'; there are: .*'link6', 'tool'"),
        (lambda r: r.jacobian(Q, "tool", "global"), "'global'; there are: 'local', 'world', 'local_world_aligned'"),
        (lambda r: r.frame_pose(Q, "toe"), "no frame is named 'toe'"),
        (lambda r: r.inverse_dynamics(Q, Q, Q, {"toe": Q}), "no frame is named 'toe'"),
        (lambda r: r.inverse_dynamics(Q, Q, Q, {"tool": Q[:3]}), r"wrench.* has shape \(3,\): its last axis must be 6"),
        (lambda r: r.inverse_dynamics(Q, Q, Q, {"tool": NAN}), "wrench.*nan"),
        (lambda r: r.elastic_forward_dynamics(Q, Q, NAN, Q, Q), r"elastic_forward_dynamics: theta\[3\] is nan"),
        (lambda r: r.elastic_inverse_dynamics(Q, Q, Q, Q, Q[:2]), r"snap has shape \(2,\)"),
        (lambda r: r.with_gravity([0.0, -9.81]), r"with_gravity: gravity has shape \(2,\): its last axis must be 3"),
        (lambda r: r.with_gravity([0.0, 0.0, np.nan]), r"gravity\[2\] is nan"),
        (lambda r: r.to_rotor(), "give one of angle= and torque=, got neither"),
        (lambda r: r.to_rotor(angle=Q, torque=Q), "give one of angle= and torque=, got both"),
        (lambda r: r.machine_with([1.0]), "machine_with: parameters must be [0-9]+ numbers, as drive_"),
        (lambda r: r.with_drives({"knee": Drive()}), "no driven joint is named 'knee'; there are: 'joint1'"),
        (lambda r: r.with_payload(1.0, Q[:3], np.eye(3), "toe"), "no frame is named 'toe'"),
        (lambda r: r.kernel("inverse_kinematics"), "no compiled function is named 'inverse_kinematics'"),
        (lambda r: r.kernel([]), r"kernel: name must be a function's name, got \[\]"),
    ],
)  # fmt: skip
def test_arguments_are_refused(backend, call, message):
    with pytest.raises(InputError, match=message):
        call(Robot(robot("xia2019").mechanism, backend=backend))


@pytest.mark.parametrize(
    ("drive", "message"),
    [
        (Drive(ratio=0.0), "joint 'joint2': ratio 0 must not be zero"),
        (Drive(ratio=np.nan), "joint 'joint2': its drive has nan"),
        (Drive(ratio=np.inf), "joint 'joint2': its drive has inf"),
        (Drive(compliance=LinearSpring(1e4)), "joint 'joint2': an elastic drive needs a rotor"),
        (Drive(rotor=Rotor(0.0), compliance=LinearSpring(1e4)), "needs a rotor with a positive inertia"),
        (Drive(rotor=Rotor(-1e-5), compliance=LinearSpring(1e4)), "needs a rotor with a positive inertia"),
        (Drive(rotor=Rotor(1e-5), compliance=LinearSpring(-3.0)), "joint 'joint2': stiffness -3.0 must be positive"),
        (Drive(rotor=Rotor(1e-5), compliance=Flexspline(1e4, 0.0)), "hardening 0.0 must be positive"),
        (Drive(link_friction=Coulomb(-1.0, 0.0, 0.1)), "coulomb -1.0 must not be negative"),
        (Drive(motor_friction=Coulomb(1.0, -0.5, 0.1)), "viscous -0.5 must not be negative"),
        (Drive(link_friction=Coulomb(1.0, 0.5, 0.0)), "smoothing 0.0 must be positive"),
        (Drive(link_friction=Stribeck(1.0, 2.0, 0.0, 0.0, 0.1)), "stribeck_velocity 0.0 must be positive"),
        (Drive(ratio=cast("Any", "100")), "joint 'joint2': ratio must be a number, got '100'"),
        (Drive(rotor=Rotor(cast("Any", None))), "joint 'joint2': inertia must be a number, got None"),
        (Drive(rotor=cast("Any", 1e-5)), "joint 'joint2': rotor must be a Rotor, got 1e-05"),
        (
            Drive(compliance=cast("Any", 1e4)),
            "joint 'joint2': compliance must be a Compliance, such as LinearSpring or Flexspline, got 10000.0",
        ),
        (elastic(compliance=cast("Any", LinearSpring)), "must be a Compliance, .* got <class .*LinearSpring'>"),
        (Drive(link_friction=cast("Any", Coulomb)), "link_friction must be a Friction, .* got <class .*Coulomb'>"),
        (elastic(compliance=HalfASpring()), "got a spring, which lacks deflection, energy"),
        (Drive(link_friction=Coulomb("1", 0.0, 0.1)), "joint 'joint2': coulomb must be a number, got '1'"),
        (cast("Any", 100.0), "joint 'joint2': its drive must be a Drive, got 100.0"),
        (elastic(damping=-5.0), "damping -5.0 must not be negative"),
        (Drive(damping=5.0), "damping 5.0 needs an elastic drive; give it a compliance"),
        (Drive(limits=Limits(effort=-5.0)), "effort -5.0 must be positive, in limits"),
        (Drive(limits=Limits(effort=0.0)), "effort 0.0 must be positive, in limits"),
        (Drive(limits=Limits(velocity=-1.0)), "velocity -1.0 must be positive, in limits"),
        (Drive(limits=Limits(lower=1.0, upper=-1.0)), "upper -1.0 must be above lower 1.0, in limits"),
        (Drive(limits=cast("Any", None)), "limits must be a Limits, got None"),
        (Drive(rotor=Rotor(1e-5, cast("Any", "no"))), "in_link_inertia 'no' must be True or False, in rotor"),
        (
            Drive(rotor=Rotor(1e-5, coupling=cast("Any", "none"))),
            "coupling 'none' must be 'reduced' or 'full', in rotor",
        ),
        (Drive(rotor=Rotor(1e-5, False, 0.4, 4e-6)), "transverse 4e-06 must be at least half of inertia 1e-05"),
        (elastic(compliance=CatalogueSpring(500.0, 600.0, 700.0, 9.0, 4.0)), "t2 4.0 must be above t1 9.0, in compl"),
        (
            elastic(compliance=CatalogueSpring(500.0, 9.0, 700.0, 4.0, 9.0)),
            "stiffness changes 77.8-fold at a corner, more than 30-fold cannot be inverted; check the units of k1",
        ),
        (elastic(compliance=CatalogueSpring(500.0, 0.0, 700.0, 4.0, 9.0)), "k2 0.0 must be positive, in compliance"),
        (elastic(compliance=Backlash(cast("Any", 1e4), 1e-3)), "spring must have torque.*, got 10000.0, in compliance"),
        (elastic(compliance=Backlash(LinearSpring(-3.0), 1e-3)), "stiffness -3.0 must be .*, in compliance.spring"),
        (waved(hardening=1e-101), "hardening 1e-101 must be positive, and at least 1e-100 1/.N m., in compliance.wave"),
        (
            waved(hardening=0.0),
            "hardening 0.0 must be positive, .*, in compliance.wave_generator",
        ),
        (waved(blend=-0.1), "blend -0.1 must be positive, in compliance.wave_generator"),
        (waved(ratio=-100.0), "ratio -100.0 must be positive, in compliance.wave_generator"),
        (erring(Harmonic(cast("Any", 1.5), 1e-5)), r"order 1.5 must be a whole .*, in kinematic_error.harmonics\[0\]"),
        (erring(Harmonic(2, 1e-5), Harmonic(2, -1e-5)), r"amplitude -1e-05 must not be neg.*harmonics\[1\]"),
        (erring(), "kinematic_error must have a harmonic; use None for no error"),
        (
            Drive(motor=Motor(0.1, ripple=(Harmonic(0, 0.1),))),
            r"order 0 must be a whole number above 0, in motor.ripple",
        ),
        (Drive(motor=Motor(0.1, cogging=(Harmonic(-6, 0.1),))), r"order -6 must be a whole .*, in motor.cogging\[0\]"),
        (Drive(motor=Motor(0.1, cogging=cast("Any", WAVE))), "motor.cogging must be a tuple of Harmonic, got Harm"),
        (Drive(motor=Motor(0.1, ripple=(WAVE, WAVE))), "torque ripple, 1.2 summed over its waves, must stay below 1"),
        (Drive(motor=Motor(0.1, voltage_limit=48.0)), "limit 48.0 needs the resistance, ohm, as well, in motor"),
        (slipping((1e3, 2e3), (1e-4,)), "hysteresis must state both for each element, got 2 stiffness and 1 reach"),
        (slipping(100.0, 1e-3), "stiffness must be a tuple of numbers, .* got 100.0, in hysteresis"),
        (slipping((), ()), r"stiffness must be a tuple of numbers, .* got \(\), in hysteresis"),
        (slipping((1e3, 0.0), (1e-4, 2e-4)), "stiffness 0.0 must be positive, in hysteresis"),
        (
            Drive(link_friction=Stribeck(1.0, 0.5, 0.0, 0.1, 0.1)),
            "static 0.5 must not be below coulomb 1.0, in link_friction",
        ),
        (
            Drive(motor_friction=LuGre(Stribeck(2.0, 1.0, 0.0, 0.1, 0.1), 1e-4, 1.0)),
            "static 1.0 must not be below coulomb 2.0, in motor_friction",
        ),
        (waved(ratio=50.0), "the wave generator's ratio 50.0 must be the drive's, 100.0"),
        (
            elastic(compliance=Backlash(waved(ratio=50.0).compliance, 1e-3)),
            "the wave generator's ratio 50.0 must be the drive's, 1",
        ),
        (Drive(link_friction=Stribeck(0.0, -1.0, 0.0, 0.1, 0.1)), "static -1.0 must not be negative, in link_friction"),
        (Drive(link_friction=LuGre(DRY, 0.0, 1.0)), "distance 0.0 must be positive, in link_friction"),
        (Drive(motor_friction=ElastoPlastic(DRY, 0.0, 1.0, 0.7)), "distance 0.0 must be positive, in motor_friction"),
        (Drive(link_friction=LuGre(cast("Any", LuGre(DRY, 1e-4, 1.0)), 1e-4, 1.0)), "sliding must have plateau, torq"),
        (
            Drive(link_friction=LuGre(replace(DRY, coulomb=0.0), 1e-4, 1.0)),
            "coulomb 0.0 must be above 0 with presliding.*, in link_friction",
        ),
        (
            Drive(motor_friction=ElastoPlastic(Stribeck(0.0, 1.0, 0.0, 0.1, 0.1), 1e-4, 1.0, 0.7)),
            "coulomb 0.0 must be above 0 with presliding.*, in motor_friction",
        ),
        (Drive(link_friction=replace(DRY, grease=cast("Any", 40.0))), "grease must have temperature, thinning, got 40"),
        (
            Drive(link_friction=replace(DRY, grease=Grease(40.0, -1.0))),
            "thinning -1.0 must not .*, in link_friction.gre",
        ),
        (Drive(ratings=Ratings(rated_torque=0.0)), "rated_torque 0.0 must be positive, in ratings"),
    ],
)
def test_drives_that_make_no_sense_are_refused(drive, message):
    with pytest.raises(ModelError, match=message) as refused:
        robot("xia2019").with_drives({"joint2": drive})
    assert str(refused.value).startswith("joint 'joint2': ")


@pytest.mark.parametrize(
    ("payload", "message"),
    [
        ((-1.0, Q[:3], np.eye(3), "tool"), "mass -1.0 kg must not be negative"),
        ((np.nan, Q[:3], np.eye(3), "tool"), "mass must be finite"),
        ((1.0, Q[:2], np.eye(3), "tool"), r"com must have shape \(3,\)"),
        ((1.0, Q[:3], np.eye(2), "tool"), r"inertia must have shape \(3, 3\)"),
        ((1.0, Q[:3], np.diag([1.0, 1.0, 5.0]), "tool"), r"payload: .* \(triangle inequality\); check its inertia"),
        ((1.0, Q[:3], np.eye(3), "base"), "'base' is fixed to the world; name a frame that moves"),
    ],
)
def test_payloads_that_make_no_sense_are_refused(payload, message):
    with pytest.raises(ModelError, match=message):
        robot("xia2019").with_payload(*payload)


@pytest.mark.parametrize("placement", [np.eye(3), 2 * np.eye(4), np.diag([1.0, 1.0, -1.0, 1.0])])
def test_a_mounting_that_is_no_placement_is_refused(placement):
    with pytest.raises(ModelError, match=r"placement must be \(4, 4\), a proper rotation and a translation"):
        robot("xia2019").with_base(placement)


def test_a_backend_that_does_not_exist_is_refused():
    with pytest.raises(InputError, match="no backend is named 'fast'; there are: 'auto', 'llvm', 'numpy'"):
        Robot(robot("xia2019").mechanism, backend=cast("Any", "fast"))


def test_errors_keep_their_evidence():
    with pytest.raises(InputError) as caught:
        robot("xia2019").inverse_dynamics(NAN, Q, Q)
    assert caught.value.evidence == {"name": "q", "index": (3,)}
