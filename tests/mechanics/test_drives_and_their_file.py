"""A robot and a drive file agree on drives: what a robot takes is written and read back, or has no words."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, cast

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
from cutpoint.formats import dump_drives, parse_drives
from cutpoint.mechanics.drives.backlash import Backlash
from cutpoint.mechanics.drives.friction import Grease
from cutpoint.mechanics.drives.wave_generator import HarmonicSpring, WaveGenerator
from cutpoint.scalars import leaves, rebuild, structure_of, with_float_leaves
from robot_library import tree

ERROR = KinematicError((Harmonic(2, 1e-4, 0.3), Harmonic(4, 2e-5, 1.0)))
GREASE = Grease(40.0, 0.03)
ROTOR = Rotor(2e-5, False, 0.4, 1.4e-5, -0.03, "full")

DRIVES = {
    "rigid": Drive(
        -80.0,
        ROTOR,
        link_friction=Stribeck(0.5, 1.5, 0.2, 0.1, 0.02, 0.1, grease=GREASE),
        motor_friction=Coulomb(1.0, 0.3, 0.02, 0.2, 0.1, GREASE),
        limits=Limits(-3.0, 3.0, 2.0, 120.0),
        motor=Motor(0.1, 0.8, 500.0, 1e-4, 12.0, 48.0, ERROR.harmonics, ERROR.harmonics),
        ratings=Ratings(40.0, 49.0, 82.0, 147.0, 209.0, 366.0, 890.0, 7000.0),
    ),
    "with play, slip and bristles": Drive(
        100.0,
        ROTOR,
        Backlash(LinearSpring(1e4), 1e-3),
        5.0,
        link_friction=ElastoPlastic(Coulomb(1.0, 0.5, 0.02), 2e-4, 3.0, 0.7),
        motor_friction=LuGre(Stribeck(0.4, 1.5, 0.2, 0.2, 0.05, per_load=0.1), 1e-4, 1.0),
        kinematic_error=ERROR,
        hysteresis=MaxwellSlip.smooth(1.4, 3e-4, 3),
    ),
    "catalogue": Drive(101.0, ROTOR, CatalogueSpring(10e3, 14e3, 16e3, 3.9, 12.0), 0.0, kinematic_error=ERROR),
    "harmonic": Drive(
        100.0, ROTOR, HarmonicSpring(Flexspline(16e3, 0.05), WaveGenerator(60.0, 2.0, 100.0, 0.02)), ratings=Ratings()
    ),
}
WHAT_NO_FILE_SAYS = {
    "a rotor without inertia": Drive(rotor=Rotor(0.0)),
    "HarmonicSpring.*LinearSpring": replace(
        DRIVES["harmonic"],
        compliance=HarmonicSpring(cast("Any", LinearSpring(1e4)), WaveGenerator(60.0, 2.0, 100.0, 0.02)),
    ),
    "MaxwellSlip": replace(DRIVES["catalogue"], hysteresis=MaxwellSlip.smooth(1.4, 3e-4, 17)),
}
NO_NUMBERS: tuple[Any, ...] = (math.nan, "1", True, 1j, (1.0, 2.0))
ODD: tuple[Any, ...] = (0.0, -0.5, 1e-9, 0.5, 1.5, 2.0, 1e6, math.inf, None)


def arm(drive: Drive) -> Robot:
    return Robot(tree(seed=1, size=1).mechanism, {"joint0": drive})


def altered(drive: Drive, value: Any) -> Iterator[Drive]:
    """The drive with this value in place of each of its numbers in turn."""
    whole = with_float_leaves(drive)
    numbers = leaves(whole)
    for k in range(len(numbers)):
        yield rebuild(whole, iter([*numbers[:k], value, *numbers[k + 1 :]]))


def takes(drive: Drive) -> bool:
    try:
        arm(drive)
    except ModelError:
        return False
    return True


def assert_reads_back(drive: Drive) -> None:
    """Equal, but for hysteresis, whose elements a file states by the loop that they open: that to rounding."""
    found = parse_drives(dump_drives({"joint0": drive}), arm(Drive()).mechanism)["joint0"]
    found, drive = with_float_leaves(found), with_float_leaves(drive)
    assert structure_of(found) == structure_of(drive)
    assert leaves(found) == pytest.approx(leaves(drive), rel=1e-12, abs=0.0)


@pytest.mark.filterwarnings("ignore::cutpoint.formats.UnitsWarning")
@pytest.mark.parametrize("name", DRIVES)
def test_what_a_robot_takes_is_written_and_read_back_or_has_no_words(name: str) -> None:
    assert takes(DRIVES[name])
    assert_reads_back(DRIVES[name])
    for drive in filter(takes, (drive for value in ODD for drive in altered(DRIVES[name], value))):
        try:
            assert_reads_back(drive)
        except InputError as unsaid:
            assert "a drive file cannot express" in str(unsaid) or "a drive file has one ratio" in str(unsaid)


@pytest.mark.parametrize("name", DRIVES)
def test_no_number_of_a_drive_may_be_something_else(name: str) -> None:
    for value in NO_NUMBERS:
        for drive in altered(DRIVES[name], value):
            with pytest.raises(ModelError, match=r"joint 'joint0': .*") as refused:
                arm(drive)
            field = refused.value.evidence["field"].split(".")[-1]
            assert field.replace("_", " ") in str(refused.value).replace("_", " ")


@pytest.mark.parametrize("what", WHAT_NO_FILE_SAYS)
def test_what_a_file_would_refuse_is_not_written(what: str) -> None:
    assert takes(WHAT_NO_FILE_SAYS[what])
    with pytest.raises(InputError, match=f"a drive file cannot express .*{what}"):
        dump_drives({"joint0": WHAT_NO_FILE_SAYS[what]})


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        (
            "friction: {motor: {coulomb: 1, per_load: 0.9, asymmetry: 0.5}}",
            "per_load 0.9 makes friction's share .* 1.35:",
        ),
        (
            "motor: {torque_constant: 1, ripple: {amplitude: 0.6, order: 6, harmonics: [[12, 0.6, 0]]}}",
            "ripple, 1.2 summed",
        ),
        ("friction: {motor: {coulomb: 1, per_load: 0.2, presliding: {distance: 1e-3}}}", "presliding .* needs an elas"),
    ],
)
def test_what_a_robot_refuses_a_file_refuses_by_its_line(entry: str, message: str) -> None:
    text = f"version: 1\ndrives:\n  joint0:\n    ratio: 2\n    {entry}"
    with pytest.raises(ModelError, match=rf"joint 'joint0': .*{message}.* \(arm.yaml:5\)"):
        parse_drives(text, arm(Drive()).mechanism, "arm.yaml")
