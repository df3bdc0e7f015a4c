"""The catalogue of drives: every name is a drive, one's own words win, and its numbers become the laws' numbers."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from urdf_text import ARM, joint, link
from urdf_text import robot as urdf

import cutpoint
from cutpoint.errors import ModelError
from cutpoint.formats import (
    catalogue_drive,
    catalogue_gear,
    catalogue_names,
    entry_of,
    load_drives,
    parse_drives,
    parse_urdf,
    save_drives,
)
from cutpoint.formats.catalogue.catalogue import catalogue_friction
from cutpoint.model import Drive
from robot_library import robot

MECHANISM = robot("xia2019").mechanism
RPM = 2 * np.pi / 60
ARC_MINUTE = np.pi / 180 / 60
STIFF = [name for name in catalogue_names() if catalogue_gear(name).stiffness]


def drive(entry: str, defaults: str = "{}") -> Drive:
    return parse_drives(f"version: 1\ndefaults: {defaults}\ndrives:\n  joint1: {entry}", MECHANISM, "arm.yaml")[
        "joint1"
    ]


def refused(entry: str, defaults: str = "{}") -> str:
    with pytest.raises(ModelError) as caught:
        drive(entry, defaults)
    return str(caught.value)


@pytest.mark.parametrize("name", catalogue_names())
def test_every_name_is_the_drive_of_a_joint(name: str) -> None:
    arm = robot("xia2019").with_drives({"joint1": drive(f"{{catalogue: {name}}}")})
    found = arm.drives["joint1"]
    assert found == catalogue_drive(name)
    assert found.ratio == -catalogue_gear(name).ratio
    assert found.is_elastic == (name in STIFF)


def test_a_robot_of_catalogue_drives_moves() -> None:
    names = ("CSG-20-100", "CSF-20-160", "CSD-20-100", "TREE-Orange-100", "FHA-17C-100", "RT1-H-CS-20-100")
    arm = robot("xia2019").with_drives(
        {joint: catalogue_drive(name) for joint, name in zip(robot("xia2019").joints, names, strict=True)}
    )
    move = cutpoint.trajectories.cycloid(np.full(6, 0.1), 0.5)
    log = cutpoint.simulate(arm, cutpoint.control.tune(arm, 5.0), move)
    assert np.isfinite(log["q"]).all()
    assert np.ptp(log["q"][:, 0]) > 0.05


def test_saved_drives_read_back_the_same(tmp_path: Path) -> None:
    path = tmp_path / "arm.drives.yaml"
    for names in np.array_split(np.array(catalogue_names()), 16):
        drives = {f"joint{k}": catalogue_drive(str(name)) for k, name in enumerate(names, start=1)}
        save_drives(path, drives)
        for joint_name, again in load_drives(path, MECHANISM).items():
            assert_alike(again, drives[joint_name])


def assert_alike(again: Drive, stated: Drive) -> None:
    """The same but for the loop's elements, which are written as the loss that they make: equal to rounding."""
    unhysteretic = {"hysteresis": None}
    assert vars(again) | unhysteretic == vars(stated) | unhysteretic
    assert (again.hysteresis is None) == (stated.hysteresis is None)
    if again.hysteresis and stated.hysteresis:
        assert again.hysteresis.reach == stated.hysteresis.reach
        assert vars(again.hysteresis)["stiffness"] == pytest.approx(vars(stated.hysteresis)["stiffness"], rel=1e-9)


@pytest.mark.parametrize(
    ("own", "changed"),
    [
        ("damping: 3", {"damping": 3.0}),
        ("ratio: 101", {"ratio": 101.0}),
        ("rotor: {inertia: 5e-5}", {"rotor": cutpoint.Rotor(5e-5)}),
        ("motor: {torque_constant: 0.1}", {"motor": cutpoint.Motor(0.1)}),
        ("limits: {torque: 5}", {"limits": cutpoint.Limits(velocity=6.806784083, effort=5.0)}),
    ],
)
def test_a_word_beside_the_name_changes_that_alone(own: str, changed: dict[str, Any]) -> None:
    whole = vars(catalogue_drive("CSG-20-100"))
    assert drive(f"{{catalogue: CSG-20-100, {own}}}") == Drive(**(whole | changed))


def test_a_word_deep_in_a_mapping_leaves_its_neighbours() -> None:
    law = drive("{catalogue: CSG-20-100, friction: {motor: {coulomb: 9}}}").motor_friction
    theirs = catalogue_drive("CSG-20-100").motor_friction
    assert law is not None and theirs is not None
    assert vars(law) == vars(theirs) | {"coulomb": 9.0}


def test_another_spring_takes_the_catalogues_place() -> None:
    found = drive("{catalogue: CSG-20-100, compliance: {linear: {stiffness: 1e4}}}")
    assert found.compliance == cutpoint.LinearSpring(1e4)
    assert found.kinematic_error == catalogue_drive("CSG-20-100").kinematic_error


@pytest.mark.parametrize(
    ("entry", "defaults"),
    [("{catalogue: CSG-20-100, compliance: rigid}", "{}"), ("{compliance: rigid}", "{catalogue: CSG-20-100}")],
)
def test_a_rigid_drive_keeps_what_is_not_its_springs(entry: str, defaults: str) -> None:
    springless = {"compliance": None, "hysteresis": None, "kinematic_error": None}
    assert drive(entry, defaults) == Drive(**(vars(catalogue_drive("CSG-20-100")) | springless))


def test_the_entrys_name_counts_instead_of_the_defaults() -> None:
    defaults = "{catalogue: CSG-20-100, damping: 3}"
    assert drive("{}", defaults) == Drive(**(vars(catalogue_drive("CSG-20-100")) | {"damping": 3.0}))
    assert drive("{catalogue: CSD-20-100}", defaults) == Drive(
        **(vars(catalogue_drive("CSD-20-100")) | {"damping": 3.0})
    )


@pytest.mark.parametrize(
    "defaults",
    [
        "{ratio: 50}",
        "{compliance: rigid}",
        "{rotor: {inertia: 1}}",
        "{compliance: {flexspline: {stiffness: 10, hardening: 0.1}, wave_generator: {stiffness: 3, hardening: 2}}}",
    ],
)
def test_the_catalogue_lies_on_the_defaults(defaults: str) -> None:
    assert drive("{catalogue: CSG-20-100}", defaults) == catalogue_drive("CSG-20-100")


def test_an_unknown_name_is_refused_with_names_that_come_near() -> None:
    message = refused("{catalogue: CSG-20-101}")
    assert "joint 'joint1'" in message
    assert "'CSG-20-100'" in message
    assert "arm.yaml:4" in message
    assert "arm.yaml:2" in refused("{}", "{catalogue: nothing}")
    with pytest.raises(ModelError, match=r"has no 'CSG-20'; did you mean 'CSG-20-50' or 'CSG-20-80' or 'CSG-20-100'\?"):
        catalogue_gear("CSG-20")


def test_a_name_must_be_a_text() -> None:
    assert "catalogue 3.0 must be text (arm.yaml:4)" in refused("{catalogue: 3}")


def test_a_mistake_beside_the_name_is_named_in_the_users_file() -> None:
    text = "version: 1\ndrives:\n  joint1:\n    catalogue: CSG-20-100\n    kinematic_error:\n      order: 400\n"
    with pytest.raises(ModelError, match=r"kinematic error .* in total 5\.8.*\(arm\.yaml:5\)"):
        parse_drives(text, MECHANISM, "arm.yaml")


def test_a_joint_that_slides_has_no_drive_of_the_catalogue() -> None:
    slide = parse_urdf(urdf(*map(link, ("base", "a")), joint("lift", "base", "a", "prismatic")))
    with pytest.raises(ModelError, match=r"'CSG-20-100' is rotary but this joint slides.*\(arm\.yaml:2\)"):
        parse_drives("version: 1\ndrives: {lift: {catalogue: CSG-20-100}}", slide, "arm.yaml")


def test_an_entry_is_the_callers_to_change() -> None:
    entry_of("CSG-20-100")["gear"]["reduction"] = 1.0
    assert entry_of("CSG-20-100")["gear"]["reduction"] == 100.0


@pytest.mark.parametrize("name", STIFF)
def test_what_makers_print_becomes_si_at_the_joint(name: str) -> None:
    gear, found = catalogue_gear(name), catalogue_drive(name)
    assert (bool(gear.ratings), bool(gear.accuracy)) == (bool(found.ratings), bool(found.kinematic_error))
    if gear.ratings and found.ratings:
        torques = (gear.ratings.rated, gear.ratings.average, gear.ratings.repeated_peak, gear.ratings.momentary_peak)
        assert (*vars(found.ratings).values(),)[:4] == torques
        assert found.ratings.rated_speed == pytest.approx(gear.ratings.rated_rpm * RPM, rel=1e-9)
    if gear.speeds and not gear.output:
        assert found.limits.velocity * gear.ratio == pytest.approx(gear.speeds.maximum_rpm * RPM, rel=1e-9)
    if gear.accuracy and found.kinematic_error:
        (wave,) = vars(found.kinematic_error)["harmonics"]
        assert (wave.order, 2 * wave.amplitude) == (2, pytest.approx(gear.accuracy.transmission_arcmin * ARC_MINUTE))


@pytest.mark.parametrize("name", STIFF)
def test_stiffness_between_the_corners_is_the_sheets(name: str) -> None:
    """The rounded corners take a quarter of the shorter segment either way: its middle and beyond are straight."""
    gear, spring = catalogue_gear(name), catalogue_drive(name).compliance
    assert gear.stiffness and spring
    softer = 1 / gear.output.spring if gear.output and gear.output.spring else 0.0
    k1, k2, k3 = (1 / (1 / k + softer) for k in (gear.stiffness.k1, gear.stiffness.k2, gear.stiffness.k3))
    first, second = gear.stiffness.t1 / k1, (gear.stiffness.t2 - gear.stiffness.t1) / k2
    places = {0.0: k1, first / 2: k1, first + second / 2: k2, first + 2 * second: k3}
    for deflection, stiffness in places.items():
        assert float(spring.tangent(deflection)) == pytest.approx(stiffness, rel=1e-9)


@pytest.mark.parametrize("name", [name for name in STIFF if catalogue_gear(name).hysteresis])
def test_hysteresis_loss_is_the_width_of_a_loop_to_rated_torque(name: str) -> None:
    """Walked in small steps, the way a simulation does."""
    gear, found = catalogue_gear(name), catalogue_drive(name)
    assert gear.hysteresis and gear.ratings and found.hysteresis and found.compliance
    at, strains, torque, widths = 0.0, (0.0,) * 4, 0.0, []
    for direction in (1, -1, 1, -1):
        while direction * torque < gear.ratings.rated:
            before, step = (at, torque), direction * 2e-7
            at, strains = at + step, found.hysteresis.strains(strains, step)
            torque = float(found.compliance.torque(at) + found.hysteresis.torque(strains))
            if before[1] * direction < 0 <= torque * direction:
                widths.append(before[0] - before[1] * (at - before[0]) / (torque - before[1]))
    assert abs(widths[-1] - widths[-2]) == pytest.approx(gear.hysteresis.loss_arcmin * ARC_MINUTE, rel=1e-6)


def at_the_input(name: str, rpm: float) -> float:
    law, ratio = catalogue_drive(name).motor_friction, catalogue_gear(name).ratio
    assert law is not None
    return float(law.torque(rpm * RPM / ratio)) / ratio


@pytest.mark.parametrize("name", [name for name in catalogue_names() if catalogue_gear(name).running])
def test_running_torque_goes_through_the_sheets_point(name: str) -> None:
    gear = catalogue_gear(name)
    assert gear.running
    own = gear.motor
    for rpm, torque in gear.running.points:
        motors = own.coulomb + own.viscous * rpm * RPM if own else 0.0
        assert at_the_input(name, rpm) == pytest.approx(torque + motors, rel=1e-9)


@pytest.mark.parametrize("name", [name for name in catalogue_names() if catalogue_gear(name).starting])
def test_starting_torque_is_the_dry_friction_unless_efficiency_says_otherwise(name: str) -> None:
    gear, law = catalogue_gear(name), catalogue_drive(name).motor_friction
    assert gear.starting and law is not None
    if gear.efficiency is None or gear.running:
        motors = gear.motor.coulomb if gear.motor else 0.0
        assert float(vars(law)["coulomb"]) == pytest.approx(gear.ratio * (gear.starting.torque + motors), rel=1e-9)
    assert vars(law)["viscous"] >= 0.0


def test_an_estimate_has_the_torque_of_the_gear_it_is_like_and_says_so() -> None:
    assert at_the_input("CSG-20-50", 2000.0) == pytest.approx(at_the_input("RT1-H-CS-20-100", 2000.0), rel=1e-9)
    assert at_the_input("SHG-32-100", 2000.0) == pytest.approx(2.1 * at_the_input("RT1-H-CS-25-100", 2000.0), rel=1e-9)
    assert catalogue_friction("CSG-20-50").estimated == ("dry", "slope", "per_load")
    assert catalogue_friction("CSF-20-80").estimated == ("slope", "per_load")
    assert catalogue_friction("CSF-20-100").estimated == ("per_load",)
    assert catalogue_friction("RT1-H-CS-20-100").estimated == ()
    friction = catalogue_gear("CSG-20-50").friction
    assert friction is not None and friction.status == "estimate" and not friction.verified


def test_every_group_names_a_source_and_only_a_source_that_was_read_verifies() -> None:
    for name in catalogue_names():
        for group in catalogue_gear(name).groups.values():
            assert group.source.title
            assert not (group.verified and group.source.key in ("recalled", "like_rt1", "like_rt1_32"))
            assert group.status == "verified" or not group.verified


def test_ratings_grow_from_rated_to_momentary_peak() -> None:
    for name in catalogue_names():
        if ratings := catalogue_gear(name).ratings:
            assert ratings.rated <= ratings.average < ratings.repeated_peak < ratings.momentary_peak, name


def test_the_entry_of_a_file_may_be_the_catalogues_own() -> None:
    arm = parse_urdf(ARM)
    text = yaml.safe_dump({"version": 1, "drives": {"shoulder": entry_of("CSF-17-50")}})
    assert parse_drives(text, arm)["shoulder"] == catalogue_drive("CSF-17-50")
