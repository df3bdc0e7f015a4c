"""Meaning of a drive file: ratios, springs, friction, limits, defaults; and that writing one inverts reading it."""

import math
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from urdf_text import ARM

from cutpoint.errors import InputError, ModelError
from cutpoint.formats import (
    DegreesWarning,
    UnitsWarning,
    catalogue_names,
    drive_of,
    dump_drives,
    load_drives,
    parse_drives,
    parse_urdf,
    save_drives,
)
from cutpoint.loading import load
from cutpoint.mechanics.drives.backlash import Backlash
from cutpoint.mechanics.drives.catalogue import CatalogueSpring
from cutpoint.mechanics.drives.compliance import Flexspline, LinearSpring
from cutpoint.mechanics.drives.friction import Coulomb, Grease, Stribeck
from cutpoint.mechanics.drives.hysteresis import MaxwellSlip
from cutpoint.mechanics.drives.kinematic_error import Harmonic, KinematicError
from cutpoint.mechanics.drives.presliding import ElastoPlastic, LuGre
from cutpoint.mechanics.drives.wave_generator import HarmonicSpring, WaveGenerator
from cutpoint.model import Drive, Limits, Motor, Ratings, Rotor
from cutpoint.robot import Robot

ROBOT = parse_urdf(ARM)
JOINTS = [body.joint.name for body in ROBOT.bodies]


def shoulder(entry: str, defaults: str = "{}") -> Drive:
    text = f"version: 1\ndefaults: {defaults}\ndrives:\n  shoulder: {entry}"
    return parse_drives(text, ROBOT)["shoulder"]


def test_limits_that_look_like_degrees_are_warned_of(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(ARM)
    (tmp_path / "arm.yaml").write_text("version: 1\ndrives: {shoulder: {limits: {position: [-180, 180]}}}")
    with pytest.warns(DegreesWarning, match=r"limits of joints 'shoulder' look like degrees; a drive file's") as caught:
        arm = load(tmp_path / "arm.urdf", drives=tmp_path / "arm.yaml")
        load_drives(tmp_path / "arm.yaml", arm.mechanism)
    assert [each.filename for each in caught] == [__file__] * 2
    for radians in ("[-3.14, 3.14]", "[-20.5, 400.0]", "[-31.4, 31.4]"):
        shoulder(f"{{limits: {{position: {radians}}}}}")


def test_nothing_stated_is_a_rigid_drive_without_gear() -> None:
    assert shoulder("{}") == Drive()
    assert shoulder("{compliance: rigid}") == Drive()


@pytest.mark.parametrize(
    ("entry", "ratio"),
    [
        ("{ratio: 101}", 101.0),
        ("{ratio: -0.5}", -0.5),
        ("{gear: {reduction: 100, fixed: flexspline}}", 101.0),
        ("{gear: {reduction: 100, fixed: circular_spline}}", -100.0),
    ],
)
def test_the_ratio_follows_from_the_part_that_is_fixed(entry: str, ratio: float) -> None:
    assert shoulder(entry).ratio == ratio


def test_every_field_reaches_its_place() -> None:
    drive = shoulder("""
      ratio: 100
      rotor: {inertia: 1.14e-5, in_link_inertia: false, mass: 0.4, transverse: 9e-6, position: -0.03, coupling: full}
      compliance: {flexspline: {stiffness: 1.6e4, hardening: 0.0432}}
      damping: 12
      friction:
        link: {coulomb: 0.49, static: 3.5, viscous: 0.15, stribeck_velocity: 0.19, smoothing: 0.02}
        motor: {coulomb: 5, viscous: 0.3, smoothing: 0.03}
      limits: {torque: 120, velocity: 2.1, position: [-3, .inf]}
      motor: {torque_constant: 0.12}""")
    assert drive == Drive(
        ratio=100.0,
        rotor=Rotor(1.14e-5, False, mass=0.4, transverse=9e-6, position=-0.03, coupling="full"),
        compliance=Flexspline(16000.0, 0.0432),
        damping=12.0,
        link_friction=Stribeck(0.49, 3.5, 0.15, 0.19, 0.02),
        motor_friction=Coulomb(5.0, 0.3, 0.03),
        limits=Limits(-3.0, math.inf, velocity=2.1, effort=120.0),
        motor=Motor(0.12),
    )
    assert isinstance(drive.damping, float)


@pytest.mark.parametrize("theta", [-0.4, 0.0, 0.7])
def test_an_unloaded_output_lags_its_motor_by_the_kinematic_error(theta: float) -> None:
    """q = theta - e(theta), with e as docs/drive-file.md states it: a measured phase goes in with this sign."""
    drive = shoulder("""{ratio: 100, rotor: {inertia: 1e-5}, compliance: {linear: {stiffness: 1e4}},
      kinematic_error: {amplitude: 1e-4, order: 2, phase: 0.3}}""")
    robot = Robot(ROBOT, {"shoulder": drive}, backend="numpy")
    lag = 1e-4 * math.sin(2 * 100 * theta + 0.3)
    torques = robot.drive_torque([theta, 0.0, 0.0], [theta - lag, 0.0, 0.0])
    np.testing.assert_allclose(torques, 0.0, atol=1e4 * 1e-15)


def test_link_friction_without_static_is_coulomb_and_viscous() -> None:
    assert shoulder("{friction: {link: {coulomb: 2, smoothing: 0.1}}}").link_friction == Coulomb(2.0, 0.0, 0.1)


@pytest.mark.parametrize("text", ["1e4", "1E4", "1.0e4", "10000", "+1.e+4", "10000.0"])
def test_every_way_to_write_a_number_is_a_number(text: str) -> None:
    assert shoulder(f"{{ratio: {text}}}").ratio == 1e4


def test_a_drive_is_laid_over_the_defaults_at_every_depth() -> None:
    defaults = "{rotor: {inertia: 1e-5}, friction: {link: {coulomb: 1, viscous: 2, smoothing: 0.1}}}"
    drive = shoulder("{rotor: {in_link_inertia: false}, friction: {link: {viscous: 3}}}", defaults)
    assert drive.rotor == Rotor(1e-5, in_link_inertia=False)
    assert drive.link_friction == Coulomb(1.0, 3.0, 0.1)


def test_a_stated_alternative_drops_the_default_one() -> None:
    spring = "{ratio: 50, rotor: {inertia: 1e-5}, compliance: {linear: {stiffness: 10}}}"
    assert shoulder("{gear: {reduction: 80, fixed: flexspline}}", spring).ratio == 81.0
    harder = shoulder("{compliance: {flexspline: {stiffness: 20, hardening: 0.1}}}", spring)
    assert harder.compliance == Flexspline(20.0, 0.1)
    assert shoulder("{compliance: rigid}", spring).compliance is None


def test_a_prismatic_joint_has_drives_too() -> None:
    text = "version: 1\ndrives: {lift: {ratio: 1256.6, rotor: {inertia: 1e-5}, compliance: {linear: {stiffness: 1e6}}}}"
    assert parse_drives(text, ROBOT)["lift"].compliance == LinearSpring(1e6)


def test_only_joints_with_an_entry_have_one() -> None:
    assert list(parse_drives("version: 1\ndrives: {lift: {ratio: 20}, shoulder: {ratio: 3}}", ROBOT)) == [
        "lift",
        "shoulder",
    ]


def test_a_joint_without_entry_keeps_the_friction_of_its_robot_file() -> None:
    shoulder, elbow, _ = (body.joint for body in ROBOT.bodies)
    assert drive_of(shoulder) == Drive()
    friction = drive_of(elbow).link_friction
    assert isinstance(friction, Coulomb)
    assert (friction.coulomb, friction.viscous) == (0.2, 0.3)


POSITIVE = st.floats(1e-12, 1e12)
NOT_NEGATIVE = st.one_of(st.just(0.0), POSITIVE)
STRIBECK = st.builds(
    lambda coulomb, more, viscous, speed, smoothing: Stribeck(coulomb, coulomb + more, viscous, speed, smoothing),
    NOT_NEGATIVE,
    NOT_NEGATIVE,
    NOT_NEGATIVE,
    POSITIVE,
    POSITIVE,
)
MAYBE = st.one_of(st.none(), POSITIVE)
COULOMB = st.builds(
    Coulomb,
    POSITIVE,
    NOT_NEGATIVE,
    POSITIVE,
    asymmetry=st.one_of(st.none(), st.floats(-0.9, 0.9)),
    grease=st.one_of(st.none(), st.builds(Grease, st.floats(-40.0, 120.0), st.floats(0.0, 0.3))),
)
GEAR_FRICTION = st.builds(Coulomb, POSITIVE, POSITIVE, POSITIVE, per_load=st.one_of(st.none(), st.floats(0.0, 0.9)))
BRISTLES = st.one_of(
    st.builds(LuGre, COULOMB, POSITIVE, NOT_NEGATIVE),
    st.builds(ElastoPlastic, COULOMB, POSITIVE, NOT_NEGATIVE, st.floats(0.0, 0.9)),
)
WAVES = st.lists(st.builds(Harmonic, st.integers(1, 48), st.floats(0.0, 0.02), st.floats(-9.0, 9.0)), max_size=3).map(
    tuple
)
MOTORS = st.builds(Motor, POSITIVE, POSITIVE, MAYBE, MAYBE, MAYBE, MAYBE, WAVES, WAVES)
LIMITS = st.builds(
    Limits,
    st.one_of(st.just(-math.inf), st.floats(-9.0, 0.0)),
    st.one_of(st.just(math.inf), st.floats(1e-3, 9.0)),
    st.one_of(st.just(math.inf), POSITIVE),
    st.one_of(st.just(math.inf), POSITIVE),
)
COMMON = {
    "ratio": st.one_of(POSITIVE, POSITIVE.map(lambda ratio: -ratio)),
    "link_friction": st.one_of(st.none(), STRIBECK, COULOMB, BRISTLES),
    "motor_friction": st.one_of(st.none(), STRIBECK, COULOMB, GEAR_FRICTION, BRISTLES),
    "limits": LIMITS,
    "motor": st.one_of(st.none(), MOTORS),
    "ratings": st.one_of(st.none(), st.builds(Ratings, POSITIVE, life=POSITIVE)),
}
COUPLINGS = st.sampled_from(["reduced", "full"])
ROTORS = st.one_of(
    st.builds(Rotor, POSITIVE, st.just(True), coupling=COUPLINGS),
    st.builds(
        lambda inertia, mass, slimness, position, coupling: Rotor(
            inertia, False, mass, inertia * slimness, position, coupling
        ),
        *(
            st.floats(1e-12, 1e11),
            NOT_NEGATIVE,
            st.one_of(st.just(0.0), st.floats(0.5, 9.0)),
            st.floats(-9.0, 9.0),
            COUPLINGS,
        ),
    ),
)
SPRINGS = st.one_of(st.builds(LinearSpring, POSITIVE), st.builds(Flexspline, POSITIVE, POSITIVE))
DRIVES = st.one_of(
    st.builds(Drive, rotor=st.one_of(st.none(), ROTORS), **COMMON),
    st.builds(Drive, rotor=ROTORS, compliance=SPRINGS, damping=st.one_of(st.none(), NOT_NEGATIVE), **COMMON),
)


@pytest.mark.parametrize(
    ("drive", "message"),
    [
        (Drive(ratio=math.nan), "joint 'elbow': its drive has nan as ratio; every number must be finite"),
        (Drive(80.0, Rotor(1e-4), LinearSpring(-5.0)), "joint 'elbow': stiffness -5.0 must be positive, in compliance"),
        ({"ratio": 3}, "dump_drives: elbow must be a Drive, got {'ratio': 3}"),
    ],
)
def test_what_no_file_could_be_read_with_is_not_written(drive: object, message: str) -> None:
    with pytest.raises((ModelError, InputError)) as caught:
        dump_drives({"elbow": drive})  # pyright: ignore[reportArgumentType]
    assert str(caught.value) == message


def test_a_rigid_drive_drops_what_goes_with_a_spring_from_defaults() -> None:
    spring = "rotor: {inertia: 1e-4}, compliance: {linear: {stiffness: 2e4}}, damping: 3, backlash: 1e-3"
    more = "hysteresis: {loss: 1e-4}, kinematic_error: {amplitude: 1e-4}"
    entries = f"{{shoulder: {{compliance: rigid}}, {JOINTS[1]}: {{}}}}"
    rigid, bent = parse_drives(f"version: 1\ndefaults: {{{spring}, {more}}}\ndrives: {entries}", ROBOT).values()
    assert rigid == Drive(rotor=Rotor(1e-4)) and bent.damping == 3.0 and bent.hysteresis is not None
    with pytest.raises(ModelError, match=r"damping 2.0 N m s/rad needs an elastic drive"):
        parse_drives("version: 1\ndrives: {shoulder: {compliance: rigid, damping: 2}}", ROBOT)


@pytest.mark.filterwarnings("ignore::cutpoint.formats.UnitsWarning")
@given(st.dictionaries(st.sampled_from(JOINTS), DRIVES))
def test_what_is_written_reads_back_the_same(drives: dict[str, Drive]) -> None:
    assert parse_drives(dump_drives(drives), ROBOT) == drives


def test_catalogue_wave_generator_and_kinematic_error_read_back_the_same() -> None:
    catalogue, flexspline = CatalogueSpring(4700.0, 6100.0, 7100.0, 2.0, 6.9), Flexspline(16e3, 0.05)
    error = KinematicError((Harmonic(2, 2e-4, 0.3), Harmonic(1, 1e-5, 0.0)))
    series = HarmonicSpring(flexspline, WaveGenerator(60.0, 2.0, 100.0, 0.02))
    drives = {
        JOINTS[0]: Drive(-100.0, Rotor(1e-5), catalogue, kinematic_error=error),
        JOINTS[1]: Drive(-100.0, Rotor(1e-5), series),
    }
    assert parse_drives(dump_drives(drives), ROBOT) == drives


@given(st.floats(1e-5, 1e-2), st.floats(1e-5, 1e-2), st.integers(1, 16), st.floats(1e-5, 1e-2))
def test_hysteresis_and_backlash_read_back_to_rounding(loss: float, reach: float, elements: int, gap: float) -> None:
    entry = f"{{loss: {loss!r}, reach: {reach!r}, elements: {elements}}}"
    own = f"rotor: {{inertia: 1e-5}}, compliance: {{linear: {{stiffness: 1e4}}}}, backlash: {gap!r}"
    drive = shoulder(f"{{ratio: 100, {own}, hysteresis: {entry}}}")
    again = parse_drives(dump_drives({"shoulder": drive}), ROBOT)["shoulder"]
    assert again.compliance == Backlash(LinearSpring(1e4), gap)
    assert isinstance(drive.hysteresis, MaxwellSlip)
    assert isinstance(again.hysteresis, MaxwellSlip)
    assert drive.hysteresis.friction == pytest.approx(1e4 * loss / 2, rel=1e-12)
    assert again.hysteresis.stiffness == pytest.approx(drive.hysteresis.stiffness, rel=1e-12)
    assert again.hysteresis.reach == drive.hysteresis.reach


@pytest.mark.parametrize(
    "drive",
    [
        Drive(80.0, Rotor(1e-5), HarmonicSpring(Flexspline(16e3, 0.05), WaveGenerator(60.0, 2.0, 100.0, 0.02))),
        Drive(80.0, Rotor(1e-5), LinearSpring(1e4), hysteresis=MaxwellSlip((1e3, 2e3), (1e-4, 3e-4))),
        Drive(link_friction=Stribeck(2.0, 1.0, 0.1, 0.1, 0.01)),
    ],
)
def test_what_a_file_has_no_words_for_is_not_dropped(drive: Drive) -> None:
    with pytest.raises(InputError, match="a drive file"):
        dump_drives({JOINTS[0]: drive})


def test_what_a_file_has_no_words_for_is_said_with_its_joint() -> None:
    with pytest.raises(InputError, match=rf"drive of '{JOINTS[1]}': a drive file cannot express Rotor\(inertia=0.0"):
        dump_drives({JOINTS[0]: Drive(80.0, Rotor(1e-5)), JOINTS[1]: Drive(80.0, Rotor(0.0))})


def test_a_saved_file_loads_and_leaves_no_draft(tmp_path: Path) -> None:
    path, drives = tmp_path / "arm.drives.yaml", {"elbow": Drive(ratio=80.0)}
    path.write_text("what was there before")
    save_drives(path, drives)
    assert load_drives(path, ROBOT) == drives
    assert list(tmp_path.iterdir()) == [path]


def test_a_failed_save_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "arm.drives.yaml"
    save_drives(path, {"elbow": Drive(ratio=80.0)})
    before = path.read_text()
    law: object = object()
    with pytest.raises(InputError, match="a drive file cannot express <object object"):
        save_drives(path, {"elbow": Drive(link_friction=law)})  # pyright: ignore[reportArgumentType]
    assert path.read_text() == before


ROTOR, SPRING = "ratio: 100, rotor: {inertia: 1.0e-4}", "compliance: {linear: {stiffness: 2.0e+4}}"


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ("ratings: {rated_speed: 2000}", "ratings.rated_speed 2000.0 rad/s looks like rpm"),
        (f"{ROTOR}, {SPRING}, backlash: 3", r"backlash 3.0 rad looks like arc minutes \(1 arcmin = 2.909e-4 rad\)"),
        (f"{ROTOR}, {SPRING}, hysteresis: {{loss: 1}}", "hysteresis.loss 1.0 rad looks like arc minutes"),
        ("ratio: 100, rotor: {inertia: 0.413}", "rotor.inertia 0.413 kg m2 looks like kg cm2"),
        ("ratio: 0.01", "ratio 0.01 looks like joint turns per motor turn"),
        ("ratio: 100, motor: {torque_constant: 52}", "motor.torque_constant 52.0 N m/A looks like mN m/A"),
        (
            "ratio: 100, motor: {torque_constant: 0.1, delay: 0.5}",
            r"motor.delay 0.5 s looks like ms \(1 ms = 1e-3 s\)",
        ),
        (
            f"{ROTOR}, compliance: {{linear: {{stiffness: 1.6}}}}",
            r"compliance.linear.stiffness 1.6 N m/rad looks like a number in 10\^4 N m/rad",
        ),
        ("ratio: 100, limits: {velocity: 180}", "limits.velocity 180.0 rad/s turns the motor at 1.72e[+]05 rpm"),
        (
            f"{ROTOR}, compliance: {{catalogue: {{k1: 3.1, k2: 5.0, k3: 5.7, t1: 14, t2: 48}}}}",
            r"compliance.catalogue.k1 3.1 N m/rad is wound up by 4.52 rad at t1: it looks like a number in 10\^4 "
            "N m/rad",
        ),
    ],
)
def test_numbers_in_the_units_of_data_sheets_are_warned_of_once(entry: str, message: str) -> None:
    text = f"version: 1\ndefaults: {{{entry}}}\ndrives: {{shoulder: {{}}, {JOINTS[1]}: {{}}}}"
    told = rf"drive of 'shoulder', '{JOINTS[1]}': {message}.* \(<string>:2\)"
    with pytest.warns(UnitsWarning, match=told) as caught:
        parse_drives(text, ROBOT)
    assert len(caught) == 1


SCREW = "ratio: 1256.6, rotor: {inertia: 1.0e-5}"


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        (
            "ratio: 0.005",
            "ratio 0.005 rad/m is a lead of 1.26e[+]03 m per turn: its unit looks different from 2 pi",
        ),
        ("ratio: 1256637.0", "ratio 1256637.0 rad/m is a lead of 5e-06 m per turn"),
        ("ratio: 1.2566", "ratio 1.2566 rad/m is a lead of 5 m per turn"),
        (f"{SCREW}, compliance: {{linear: {{stiffness: 150}}}}", "stiffness 150.0 N/m looks like N/mm or N/µm"),
        ("ratio: 1256.6, rotor: {inertia: 0.22}", "rotor.inertia 0.22 kg m2 looks like kg cm2"),
        (f"{SCREW}, motor: {{torque_constant: 95}}", "motor.torque_constant 95.0 N m/A looks like mN m/A"),
        (f"{SCREW}, ratings: {{rated_speed: 3000}}", "ratings.rated_speed 3000.0 rad/s looks like rpm"),
    ],
)
def test_so_are_those_of_a_joint_that_slides(entry: str, message: str) -> None:
    with pytest.warns(UnitsWarning, match=rf"drive of 'lift': .*{message}.* \(<string>:1\)"):
        parse_drives(f"{{version: 1, drives: {{lift: {{{entry}}}}}}}", ROBOT)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        parse_drives(f"{{version: 1, drives: {{lift: {{{SCREW}}}}}}}", ROBOT)
        parse_drives("{version: 1, drives: {lift: {ratio: 1}}}", ROBOT)


@dataclass(frozen=True)
class Quadratic(Coulomb):
    quadratic: float = 0.0


@pytest.mark.parametrize("law", [Quadratic(1.0, 0.1), LuGre(Quadratic(1.0, 0.1), 1e-3, 1.0)])
def test_a_drive_file_has_no_words_for_laws_of_ones_own(law: Any) -> None:
    with pytest.raises(InputError, match=r"drive of 'elbow': a drive file cannot express Quadratic\(.*of your own"):
        dump_drives({"elbow": Drive(80.0, Rotor(1e-5), LinearSpring(1e4), motor_friction=law)})


def test_no_drive_of_the_catalogue_is_warned_of() -> None:
    for name in catalogue_names():
        shoulder(f"{{catalogue: {name}}}")


def test_a_motor_without_a_gear_may_be_large() -> None:
    shoulder("{rotor: {inertia: 0.4}, motor: {torque_constant: 12}, limits: {velocity: 180}}")


def test_a_capital_letter_and_a_list_of_drives_are_told_what_is_meant() -> None:
    with pytest.raises(
        ModelError, match=r"unknown key 'K1' in compliance.catalogue; known keys: .*; did you mean 'k1'\?"
    ):
        shoulder("{compliance: {catalogue: {K1: 3.1e4}}}")
    with pytest.raises(ModelError, match=r"drives .* must be a mapping: one entry per driven joint, by joint"):
        parse_drives("version: 1\ndrives: [{joint: shoulder}]", ROBOT)
