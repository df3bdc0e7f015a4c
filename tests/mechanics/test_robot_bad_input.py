"""What the public face of a robot refuses: each with one error that names thing, value and rule."""

from typing import Any, cast

import numpy as np
import pytest

from cutpoint import Coulomb, Drive, Flexspline, InputError, LinearSpring, ModelError, Robot, Rotor, Stribeck
from robot_library import BACKENDS, robot

Q = np.zeros(6)
NAN = np.array([0.0, 0.0, 0.0, np.nan, 0.0, 0.0])


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda r: r.inverse_dynamics(NAN, Q, Q), r"inverse_dynamics: q\[3\] is nan, every number must be finite"),
        (lambda r: r.inverse_dynamics(Q, Q, [[0] * 6, [np.inf] * 6]), r"inverse_dynamics: a\[1, 0\] is inf"),
        (lambda r: r.mass_matrix(Q + 1e16), r"mass_matrix: q\[0\] is 1e\+16, every number must be .* within 1e\+15"),
        (lambda r: r.mass_matrix([Q, Q - 1e16]), r"mass_matrix: q\[1, 0\] is -1e\+16, every number must be finite and"),
        (lambda r: r.mass_matrix(Q[:5]), r"mass_matrix: q has shape \(5,\), its last axis must be 6"),
        (lambda r: r.mass_matrix(0.0), r"mass_matrix: q has shape \(\), its last axis must be 6"),
        (lambda r: r.mass_matrix(np.zeros((6, 1))), r"q has shape \(6, 1\), its last axis must be 6"),
        (lambda r: r.mass_matrix("straight"), r"mass_matrix: q must be numbers of shape \(\.\.\., 6\)"),
        (lambda r: r.mass_matrix([[0.0] * 6, [0.0] * 5]), r"mass_matrix: q must be numbers of shape"),
        (lambda r: r.mass_matrix(Q * 1j), "mass_matrix: q must be numbers"),
        (lambda r: r.inverse_dynamics([Q] * 2, [Q] * 3, Q), r"leading axes do not broadcast: q \(2,\), v \(3,\)"),
        (lambda r: r.jacobian(Q, "toe"), "no frame is named 'toe'; there are: .*'link6', 'tool'"),
        (lambda r: r.jacobian(Q, "tool", "global"), "'global'; there are: 'local', 'world', 'local_world_aligned'"),
        (lambda r: r.frame_pose(Q, "toe"), "no frame is named 'toe'"),
        (lambda r: r.inverse_dynamics(Q, Q, Q, {"toe": Q}), "no frame is named 'toe'"),
        (lambda r: r.inverse_dynamics(Q, Q, Q, {"tool": Q[:3]}), r"wrench.* has shape \(3,\), its last axis must be 6"),
        (lambda r: r.inverse_dynamics(Q, Q, Q, {"tool": NAN}), "wrench.*nan"),
        (lambda r: r.elastic_forward_dynamics(Q, Q, NAN, Q, Q), r"elastic_forward_dynamics: theta\[3\] is nan"),
        (lambda r: r.elastic_inverse_dynamics(Q, Q, Q, Q, Q[:2]), r"snap has shape \(2,\)"),
        (lambda r: r.with_gravity([0.0, -9.81]), r"with_gravity: gravity has shape \(2,\), its last axis must be 3"),
        (lambda r: r.with_gravity([0.0, 0.0, np.nan]), r"gravity\[2\] is nan"),
        (lambda r: r.to_rotor(), "either angle= or torque="),
        (lambda r: r.to_rotor(angle=Q, torque=Q), "either angle= or torque="),
        (lambda r: r.with_drives({"knee": Drive()}), "no driven joint is named 'knee'; there are: 'joint1'"),
        (lambda r: r.with_payload(1.0, Q[:3], np.eye(3), "toe"), "no frame is named 'toe'"),
        (lambda r: r.kernel("inverse_kinematics"), "no compiled function is named 'inverse_kinematics'"),
    ],
)  # fmt: skip
def test_arguments_are_refused(backend, call, message):
    with pytest.raises(InputError, match=message):
        call(Robot(robot("xia2019").mechanism, backend=backend))


@pytest.mark.parametrize(
    ("drive", "message"),
    [
        (Drive(ratio=0.0), "joint 'joint2': ratio 0 must not be zero"),
        (Drive(ratio=np.nan), "joint 'joint2': its drive holds nan"),
        (Drive(ratio=np.inf), "joint 'joint2': its drive holds inf"),
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
        (Drive(compliance=cast("Any", 1e4)), "joint 'joint2': compliance must be a Compliance, got 10000.0"),
        (Drive(link_friction=Coulomb("1", 0.0, 0.1)), "joint 'joint2': coulomb must be a number, got '1'"),
        (cast("Any", 100.0), "joint 'joint2': its drive must be a Drive, got 100.0"),
    ],
)
def test_drives_that_make_no_sense_are_refused(drive, message):
    with pytest.raises(ModelError, match=message):
        robot("xia2019").with_drives({"joint2": drive})


@pytest.mark.parametrize(
    ("payload", "message"),
    [
        ((-1.0, Q[:3], np.eye(3), "tool"), "mass -1.0 kg must not be negative"),
        ((np.nan, Q[:3], np.eye(3), "tool"), "mass must be finite"),
        ((1.0, Q[:2], np.eye(3), "tool"), r"com must have shape \(3,\)"),
        ((1.0, Q[:3], np.eye(2), "tool"), r"inertia must have shape \(3, 3\)"),
        ((1.0, Q[:3], np.diag([1.0, 1.0, 5.0]), "tool"), "triangle inequality"),
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
