"""Arguments of the wrong kind, or too many of them: an error names the argument, what it must be and what it is."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

import cutpoint
from cutpoint import Drive, InputError, MaxwellSlip, ModelError, Robot, derivatives
from cutpoint.robots import XIA2019_URDF
from robot_library import robot

Z, EYE = np.zeros(6), np.eye(3)
NAN = np.array([0.0, 0.0, np.nan, 0.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda r: r.mass_matrix(None), r"mass_matrix: q must be numbers of shape \(\.\.\., 6\), got None$"),
        (lambda r: r.mass_matrix("1"), r"mass_matrix: q must be numbers of shape \(\.\.\., 6\), got '1'$"),
        (lambda r: r.mass_matrix({"joint1": 1}), r"q must be numbers of shape .*, got {'joint1': 1}$"),
        (lambda r: r.mass_matrix(Z * 1j), r"q must be numbers of shape .*, got an array \(6,\) of complex128$"),
        (lambda r: r.integrate(Z, Z, None), r"^integrate: dt must be numbers, got None$"),
        (lambda r: r.integrate(Z, Z, np.inf), r"^integrate: dt is inf: every number must be finite$"),
        (lambda r: r.random("x"), r"^random: seed must be a whole number from 0, or a NumPy Generator, got 'x'$"),
        (lambda r: r.random(-1), r"^random: seed must be a whole number from 0, .*, got -1$"),
        (lambda r: r.with_gravity(None), r"^with_gravity: gravity must be numbers of shape \(\.\.\., 3\), got None$"),
        (lambda r: r.with_gravity(EYE), r"^with_gravity: gravity must be one vector \(3,\), got an array \(3, 3\)"),
        (lambda r: r.inverse_dynamics(Z, Z, Z, {"tool": NAN}), r"^inverse_dynamics: the wrench at 'tool'\[2\] is nan"),
        (lambda r: r.forward_dynamics(Z, Z, Z, {"link6": Z[:3]}), r"the wrench at 'link6' has shape \(3,\): its last"),
        (lambda r: r.inverse_dynamics(Z, Z, Z, {"tool": None}), r"the wrench at 'tool' must be numbers .* got None$"),
        (lambda r: r.inverse_dynamics(Z, Z, Z, Z), r"external must be wrenches .* by the frame's name, got an array"),
        (lambda r: r.forward_dynamics(Z, Z, Z, "tool"), r"^forward_dynamics: external must be wrenches .* got 'tool'$"),
        (lambda r: r.frame_pose(Z, ["tool"]), r"no frame is named \['tool'\]; there are: .*'tool'$"),
        (lambda r: r.frame_pose(Z, "Link_6"), r"named 'Link_6'; there are: .*'tool'; did you mean 'link6'\?$"),
        (lambda r: r.frame_pose(Z, "elbow"), r"no frame is named 'elbow'; there are: .*'tool'$"),
        (lambda r: r.jacobian(Z, "tool", ["local"]), r"way to express a velocity is named \['local'\]; there are: 'lo"),
        (lambda r: r.random(0, 2.5), r"^random: size must be a whole number from 0, or a tuple of them, got 2.5$"),
        (lambda r: r.random(0, (2, -1)), r"^random: size must be .*, got \(2, -1\)$"),
        (lambda r: r.with_drives(None), r"^with_drives: drives must be a mapping of joint names to Drives, got None$"),
        (lambda r: r.with_drives([Drive()]), r"^with_drives: drives must be a mapping of joint names to Drives"),
        (lambda r: r.with_payload(1.0, Z[:3], EYE, ["tool"]), r"no frame is named \['tool'\]"),
        (lambda r: Robot(None), r"^Robot: mechanism must be a Mechanism \(cutpoint.load reads files\), got None$"),
        (lambda r: Robot(r.mechanism, [Drive()]), r"^Robot: drives must be a mapping of joint names to Drives"),
        (lambda r: cutpoint.load(5), r"^load: path must be the path of a robot file, got 5$"),
        (
            lambda r: cutpoint.load(XIA2019_URDF.read_text()),
            r"^load: path must be the path of a robot file, not its text: write that to a file, got '<.{,40}'$",
        ),
        (lambda r: cutpoint.load(XIA2019_URDF, drives=5), r"^load: drives must be the path of a drive file, .* got 5"),
        (lambda r: cutpoint.load(XIA2019_URDF, lock=["joint1"]), r"^load: lock must be a coordinate for each joint"),
    ],
)  # fmt: skip
def test_arguments_of_the_wrong_kind_are_refused(call: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        call(robot("xia2019", "numpy"))


@pytest.mark.parametrize("way", ["to_rotor", "from_rotor"])
@pytest.mark.parametrize("what", ["angle", "torque"])
@pytest.mark.parametrize(
    ("value", "message"),
    [
        (NAN, r"\[2\] is nan: every number must be finite"),
        (1.0, r" has shape \(\): its last axis must be 6"),
        (np.zeros(7), r" has shape \(7,\): its last axis must be 6"),
        ("1", r" must be numbers of shape \(\.\.\., 6\), got '1'"),
        (Z * 1j, r" must be numbers of shape \(\.\.\., 6\), got an array \(6,\) of complex128"),
    ],
)
def test_across_a_gear_goes_what_has_a_number_for_each_drive(way: str, what: str, value: Any, message: str) -> None:
    with pytest.raises(InputError, match=f"^{way}: {what}{message}$"):
        getattr(robot("xia2019"), way)(**{what: value})


@pytest.mark.parametrize(
    ("payload", "message"),
    [
        (("1", Z[:3], EYE), r"mass must have shape \(\) and hold real numbers, got shape \(\) of <U1"),
        ((1j, Z[:3], EYE), r"mass must have .* real numbers, got shape \(\) of complex128"),
        ((None, Z[:3], EYE), r"mass must have .* real numbers, got shape \(\) of object"),
        ((1.0, Z[:3] * 1j, EYE), r"com must have .* real numbers, got shape \(3,\) of complex128"),
        ((1.0, ["0", "0", "0"], EYE), r"com must have .* real numbers, got shape \(3,\) of <U1"),
        ((1.0, [[1], [1, 2]], EYE), r"com must have shape \(3,\) and hold real numbers, got shape \(2,\) of object"),
        ((1.0, Z[:3], EYE * 1j), r"inertia must have .* real numbers, got shape \(3, 3\) of complex128"),
    ],
)
def test_payloads_are_real_numbers(payload: Any, message: str) -> None:
    with pytest.raises(ModelError, match=message):
        robot("xia2019").with_payload(*payload, "tool")


@pytest.mark.parametrize(
    "placement",
    [np.eye(4) * (1 + 0j), np.eye(4).astype(str), np.full((4, 4), np.inf), np.full((4, 4), 1e200), None, [[1], [1, 2]]],
)
def test_mountings_are_real_numbers(placement: Any) -> None:
    with pytest.raises(ModelError, match=r"placement must be \(4, 4\), a proper rotation and a translation"):
        robot("xia2019").with_base(placement)


def test_whole_numbers_of_any_kind_are_a_batch_size() -> None:
    ours = robot("xia2019")
    for size in (3, np.int64(3), (3,), [3], np.array([3])):
        np.testing.assert_array_equal(ours.random(0, size), ours.random(0, (3,)))  # type: ignore[arg-type]


def test_no_wrench_is_as_none() -> None:
    ours = robot("xia2019")
    np.testing.assert_array_equal(ours.inverse_dynamics(Z, Z, Z, {}), ours.inverse_dynamics(Z, Z, Z))
    at_rest = ours.inverse_dynamics(Z, Z, Z, {"tool": Z.tolist(), "link3": Z})
    np.testing.assert_allclose(at_rest, ours.inverse_dynamics(Z, Z, Z), rtol=1e-12, atol=1e-12)


# how many derivatives


def full_coupling(*joints: str) -> Robot:
    arm = robot("xia2019", "numpy")
    drives = {name: arm.drives[name] for name in joints}
    full = {n: replace(d, rotor=replace(d.rotor, coupling="full")) for n, d in drives.items() if d.rotor}
    return arm.with_drives(full)


COUPLED = [((), 4), (("joint1",), 4), (("joint6",), 6), (("joint1", "joint6"), 6), (("joint5", "joint6"), 8)]


@pytest.mark.parametrize(("joints", "needed"), COUPLED)
def test_rotors_that_ride_on_bending_joints_take_two_derivatives_each(joints: tuple[str, ...], needed: int) -> None:
    ours = full_coupling(*joints)
    assert ours.derivatives_needed == needed
    for function in (ours.elastic_inverse_dynamics, lambda *x: derivatives.elastic_inverse_dynamics(ours, *x)):
        for surplus in (Z, NAN, "nonsense"):
            with pytest.raises(
                InputError, match=rf"{needed} derivatives .* {needed + 1} are given; pass strains .* by name"
            ):
                function(*[Z] * (needed + 1), surplus)  # pyright: ignore[reportArgumentType]
        if needed > 4:
            with pytest.raises(InputError, match=rf"2 more derivatives .* derivative_{needed} missing"):
                function(*[Z] * (needed - 1))
    with pytest.raises(InputError, match="4 derivatives of the position are needed, v, a, jerk, snap: 5 are given"):
        ours.elastic_inverse_dynamics(*[Z] * 6, quasi_rigid=True)


def test_of_n_rotors_with_full_coupling_along_an_arm_the_first_takes_none() -> None:
    ours = full_coupling(*robot("xia2019").joints)
    assert ours.derivatives_needed == 2 * (len(ours.joints) + 1)


def test_strains_by_position_are_refused_where_they_would_be_taken_for_a_derivative() -> None:
    arm = robot("xia2019", "numpy")
    drives = {n: replace(d, hysteresis=MaxwellSlip((500.0,), (1e-3,))) for n, d in arm.drives.items()}
    ours, strains = arm.with_drives(drives), np.full(6, 1e-3)
    with pytest.raises(InputError, match=r"pass strains and options by name, as in strains=\.\.\."):
        ours.elastic_inverse_dynamics(Z, Z, Z, Z, Z, strains)
    held = ours.elastic_inverse_dynamics(Z, Z, Z, Z, Z, strains=strains)
    assert np.abs(held.theta - ours.elastic_inverse_dynamics(Z, Z, Z, Z, Z).theta).min() > 1e-6


@pytest.mark.parametrize("option", ["friction_rates", "quasi_rigid"])
@pytest.mark.parametrize("value", [[1], "x", None, Z])
def test_options_are_true_or_false(option: str, value: Any) -> None:
    arm = robot("xia2019")
    for call in (arm.elastic_inverse_dynamics, partial(derivatives.elastic_inverse_dynamics, arm)):
        with pytest.raises(InputError, match=rf"elastic_inverse_dynamics: {option} must be True or False, got "):
            call(Z, Z, Z, Z, Z, **{option: value})
