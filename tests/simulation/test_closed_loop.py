"""Laws of the closed loop: rest stays rest, steps are fine enough, limits act last, and numbers are inputs."""

from dataclasses import replace

import numpy as np
import pytest

from cutpoint import Drive, InputError, LinearSpring, Log, Rotor, State, simulate
from cutpoint.control import PD, Feedforward, GravityCompensation
from cutpoint.model import Limits, Motor
from cutpoint.simulation.cache import programs_for
from cutpoint.simulation.controllers import admitted
from cutpoint.simulation.loop import loop as loops
from cutpoint.trajectories import cycloid, quintic
from robot_library import Robot, assert_close, frictionless, robot

KP, KD = [2000.0, 2000, 1000, 500, 300, 200], [60.0, 60, 35, 20, 12, 10]
POSE = np.array([0.3, 0.9, -0.6, 0.4, 0.8, -0.5])


@pytest.mark.parametrize("rung", ["gravity", "elastic"])
@pytest.mark.parametrize("name", ["xia2019", "mixed", "tree"])
def test_the_initial_state_is_an_equilibrium(name, rung):
    """Links at rest, each motor leading by what gravity bends its drive: held there, nothing moves."""
    ours = robot(name)
    q = np.linspace(-0.8, 0.9, ours.nv)
    hold = quintic(q, 0.1, start=q)
    log = simulate(ours, Feedforward(ours, rung), hold, substeps=50)
    assert np.abs(log["q"] - q).max() < 1e-9
    assert np.abs(log["theta_dot"]).max() < 1e-7
    assert_close(log["joint_torque"][0], ours.gravity_forces(q), 1e-9)


def test_without_a_reference_the_arm_starts_at_zero_in_equilibrium():
    ours = robot("xia2019")
    log = simulate(ours, GravityCompensation(ours) + PD(KP, KD, side="motor"), duration=0.02, substeps=50)
    assert_close(log["theta"][0], ours.static_deflection(np.zeros(6)), 1e-15, scale=1.0)
    assert np.abs(log["v"][0]).max() == 0.0


def test_of_a_rigid_drive_the_motor_starts_where_its_link_does():
    """Whatever is rounded on the way, as in a log that a run goes on from; anywhere else is refused."""
    ours, pose = robot("rigid"), POSE / 3
    start = State(q=pose, v=pose, theta=pose * (1 + 1e-12), theta_dot=pose - 1e-12)
    log = simulate(ours, duration=0.01, initial=start)
    assert np.array_equal(log["theta"], log["q"]) and np.array_equal(log["theta_dot"], log["v"])
    for name in ("theta", "theta_dot"):
        away = start._replace(**{name: pose + 1e-3 * np.eye(6)[2]})
        message = (
            rf"initial.{name}\[2\] is -0.199; the drive of 'joint3' is rigid, so its motor moves as its link, -0.2"
        )
        with pytest.raises(InputError, match=message):
            simulate(ours, duration=0.01, initial=away)


def test_a_log_tells_the_steps_that_were_taken():
    """An integrator that adapts its own has none; a controller that acts at every instant takes it too."""
    adapted = {"accuracy": "reference", "substeps": None, "steps_set_by": "the adaptive integrator"}
    ours, law = frictionless(robot("xia2019")), PD(KP, KD, side="motor")
    fixed = simulate(ours, law, duration=0.002, accuracy="fine").meta
    assert fixed["accuracy"] == "fine" and fixed["substeps"] > 0
    for hold, accuracy in ((True, "reference"), (False, "standard")):
        meta = simulate(ours, law, duration=0.002, accuracy=accuracy, hold=hold).meta
        assert {name: meta[name] for name in adapted} == adapted and meta["hold"] is hold
    with pytest.raises(
        InputError, match=r"substeps=3 has no effect with accuracy 'reference' or hold=False: leave it out"
    ):
        simulate(ours, law, duration=0.002, accuracy="reference", substeps=3)


@pytest.mark.parametrize("laws", ["PD", "PD and elastic feedforward"])
def test_rms_at_fine_steps_is_that_of_much_finer_ones(laws):
    """Trajectories under stick-slip are ill-conditioned; their RMS is within 2 % of that at 5 times finer steps."""
    ours = robot("xia2019")
    controller = PD(KP, KD, side="motor") if laws == "PD" else PD(KP, KD, side="motor") + Feedforward(ours)
    move = cycloid(np.deg2rad([45.0, 30, 30, 45, 30, 45]), 1.0)
    log = simulate(ours, controller, move, accuracy="fine")
    finer = simulate(ours, controller, move, substeps=5 * log.meta["substeps"])
    for channel in ("position_error", "feedback_torque"):
        ratio = log.rms(channel) / finer.rms(channel)
        assert np.abs(ratio - 1.0).max() < 0.02


def test_feedforward_needs_no_feedback_where_the_model_is_right():
    """Rung by rung the error falls; the elastic rung leaves only what holding commands for a sample leaves."""
    ours = frictionless(robot("xia2019"))
    move = cycloid(POSE, 1.0)
    error = {}
    for rung in ("gravity", "rigid", "rotor", "elastic"):
        error[rung] = np.linalg.norm(simulate(ours, PD(KP, KD) + Feedforward(ours, rung), move).rms("position_error"))
    error["none"] = np.linalg.norm(simulate(ours, PD(KP, KD), move).rms("position_error"))
    assert error["none"] > error["gravity"] > error["rigid"] > error["rotor"] > 20 * error["elastic"]


def limited(ours: Robot, effort: float) -> Robot:
    return ours.with_drives(
        {n: Drive(d.ratio, d.rotor, d.compliance, limits=Limits(effort=effort)) for n, d in ours.drives.items()}
    )


def saturated(backend: str = "llvm") -> Log:
    ours = limited(robot("xia2019", backend), 12.0)
    return simulate(ours, PD(KP, KD) + Feedforward(ours), cycloid(POSE, 0.3), duration=0.05)


def test_torque_limits_act_after_all_laws_are_added():
    log = saturated()
    assert np.array_equal(log["motor_torque"], np.clip(log["command_torque"], -12.0, 12.0))
    assert (np.abs(log["command_torque"]) > 12.0).any()
    assert (np.abs(log["feedforward_torque"]) > 12.0).any()
    shares = (np.abs(log["command_torque"]) > 12.0).mean(axis=0)
    assert log.meta["over_limit"] == {joint: share for joint, share in zip(log.joints, shares, strict=True) if share}
    assert 0 < len(log.meta["over_limit"]) < 6


def test_what_the_voltage_does_not_allow_at_a_speed_counts_as_over_the_limit():
    arm, motor = robot("xia2019"), Motor(torque_constant=0.1, resistance=0.5, voltage_limit=0.4)
    weak = arm.with_drives({"joint1": replace(arm.drives["joint1"], motor=motor)})
    log = simulate(weak, PD(KP, KD), cycloid(POSE, 0.3), duration=0.05)
    asked, gain = log["command_torque"][:, 0], 0.1 * weak.drives["joint1"].ratio
    current = (np.sign(asked) * 0.4 - gain * log["theta_dot"][:, 0]) / 0.5  # what is left of the voltage drives it
    share = (np.abs(asked) > gain * np.abs(current)).mean()
    assert 0 < share < 1 and log.meta["over_limit"] == {"joint1": share}


def test_the_smaller_of_the_drives_and_the_joints_limit_counts():
    ours = robot("panda")
    efforts = [body.joint.limits.effort for body in ours.mechanism.bodies]
    pushed = simulate(ours, lambda memory, m, r: (memory, m.q * 0 + 1e4), duration=2e-3)
    assert_close(pushed["motor_torque"][0], efforts, 1e-15)
    weak = ours.with_drives({ours.joints[0]: Drive(limits=Limits(effort=3.0))})
    pushed = simulate(weak, lambda memory, m, r: (memory, m.q * 0 + 1e4), duration=2e-3)
    assert_close(pushed["motor_torque"][0], [3.0, *efforts[1:]], 1e-15)


@pytest.mark.parametrize("name", ["tree", "xia2019"])
def test_a_disturbance_equal_to_the_weight_holds_the_robot(name):
    """Disturbances push on the links as joint torques do."""
    ours = frictionless(robot(name))
    q = np.linspace(-0.8, 0.9, ours.nv)
    start = State(q=q, theta=q)  # springs unbent: the disturbance alone bears the links
    weight = ours.gravity_forces(q)
    for given in (lambda t: weight, lambda t: np.outer(t * 0 + 1, weight)):
        log = simulate(ours, duration=0.1, initial=start, disturbances=given)
        assert np.abs(log["q"] - q).max() < 1e-9


def test_a_disturbance_acts_at_the_times_it_is_given_for():
    ours = robot("tree").with_gravity([0.0, 0.0, 0.0])
    log = simulate(ours, duration=0.01, disturbances=lambda t: np.outer(t > 4.5e-3, np.eye(ours.nv)[0]))
    assert np.abs(log["v"][:6]).max() == 0.0
    assert log["v"][6, 0] == pytest.approx(
        1e-3 * ours.forward_dynamics(ours.neutral(), log["v"][0], np.eye(ours.nv)[0])[0], rel=1e-2
    )


def test_other_gains_drives_and_limits_compile_nothing_again(monkeypatch):
    ours, move = frictionless(robot("xia2019")), cycloid(POSE, 1.0)
    first = simulate(ours, PD(KP, KD) + Feedforward(ours), move, 0.05)

    def never(*_: object, **__: object) -> None:
        raise AssertionError("compiled again")

    monkeypatch.setattr(loops, "compile_program", never)
    softer = limited(
        ours.with_drives({n: Drive(90.0, Rotor(2e-5), d.compliance) for n, d in ours.drives.items()}), 50.0
    )
    second = simulate(softer, PD(np.array(KP) / 2, KD) + Feedforward(softer), move, 0.05)
    assert not np.array_equal(first["q"], second["q"])
    monkeypatch.undo()
    fresh = Robot(robot("xia2019").mechanism, softer.drives, backend="numpy")
    alone = simulate(fresh, PD(np.array(KP) / 2, KD) + Feedforward(fresh), move, 0.05)
    assert_close(second["q"], alone["q"], 1e-10)


def test_another_kind_of_drive_is_another_program():
    ours = frictionless(robot("xia2019"))
    law, other = admitted(ours, PD(KP, KD)), admitted(ours, PD(np.array(KP) * 3, KD))
    stiff = ours.with_drives({ours.joints[0]: Drive(100.0, Rotor(1e-5), LinearSpring(1e4))})
    encoders = loops.Encoders((None, None), (None, None), 0, False, 0, 6)
    assert programs_for(ours, law, encoders, ()) is not programs_for(stiff, law, encoders, ())
    assert programs_for(ours, law, encoders, ()) is programs_for(ours, other, encoders, ())


@pytest.mark.parametrize("accuracy", ["standard", "fine", "reference"])
def test_backends_give_the_same_run(accuracy):
    runs = [simulate(o, PD(KP, KD) + Feedforward(o), cycloid(POSE, 0.2), 5e-3, accuracy=accuracy)
            for o in (frictionless(robot("xia2019", backend)) for backend in ("llvm", "numpy"))]  # fmt: skip
    for channel in ("q", "theta", "command_torque", "joint_torque"):
        assert_close(runs[0][channel], runs[1][channel], 1e-9)
