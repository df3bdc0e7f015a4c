"""Wrong and hostile drive files: one clear error each, with joint, field, value, rule and line."""

from pathlib import Path

import pytest
from urdf_text import ARM, joint, link, robot

from cutpoint.errors import ModelError
from cutpoint.formats import load_drives, parse_drives, parse_urdf
from cutpoint.formats.safe_yaml import MAXIMUM_BYTES

ROBOT = parse_urdf(ARM)


def refused(text: str | bytes, mechanism=ROBOT) -> str:
    with pytest.raises(ModelError) as caught:
        parse_drives(text, mechanism, "arm.yaml")
    return str(caught.value)


ELASTIC = "rotor: {inertia: 1e-5}, compliance"

ENTRIES = {
    "zero ratio": ("{ratio: 0}", "ratio 0 must not be zero: motor turns per joint turn, signed"),
    "text for a number": ("{ratio: ten}", "ratio 'ten' must be a number"),
    "quoted number": ("{ratio: '10'}", "ratio '10' must be a number"),
    "number with ornaments": ("{ratio: 1_0}", "ratio '1_0' must be a number"),
    "sexagesimal": ("{ratio: 1:30}", "ratio '1:30' must be a number"),
    "nan": ("{ratio: .nan}", "ratio '.nan' must be a number"),
    "infinite": ("{ratio: .inf}", "ratio inf must be finite"),
    "unknown key": (
        "{friction: {link: {columb: 1}}}",
        "unknown key 'columb' in friction.link; known keys:"
        " 'coulomb', 'static', 'viscous', 'stribeck_velocity', 'smoothing', 'asymmetry', 'presliding', 'grease';"
        " did you mean 'coulomb'?",
    ),
    "negative stiffness": (
        f"{{{ELASTIC}: {{linear: {{stiffness: -3}}}}}}",
        "compliance.linear.stiffness -3.0 N m/rad must be positive",
    ),
    "missing hardening": (
        f"{{{ELASTIC}: {{flexspline: {{stiffness: 3}}}}}}",
        "'hardening' (1/(N m)) is missing in compliance.flexspline: c_f: stiffness grows by 1 + (c_f torque)^2",
    ),
    "two springs": (
        f"{{{ELASTIC}: {{linear: {{stiffness: 3}}, flexspline: {{stiffness: 3, hardening: 1}}}}}}",
        "compliance must state exactly one of 'linear', 'flexspline', 'catalogue'",
    ),
    "no spring": (f"{{{ELASTIC}: {{}}}}", "compliance must state exactly one of 'linear', 'flexspline', 'catalogue'"),
    "word for a spring": (
        "{compliance: soft}",
        "compliance 'soft' must be 'rigid' or a mapping with keys from"
        " 'linear', 'flexspline', 'wave_generator', 'catalogue'",
    ),
    "wave generator alone": (
        f"{{{ELASTIC}: {{linear: {{stiffness: 3}}, wave_generator: {{stiffness: 6, hardening: 2}}}}}}",
        "compliance.wave_generator goes in series with 'flexspline', which is not stated",
    ),
    "corners out of order": (
        f"{{{ELASTIC}: {{catalogue: {{k1: 1, k2: 2, k3: 3, t1: 5, t2: 4}}}}}}",
        "compliance.catalogue.t2 4.0 N m must be above t1 5.0",
    ),
    "error of a rigid drive": (
        "{kinematic_error: {amplitude: 1e-4}}",
        "kinematic_error needs an elastic drive; give it a compliance",
    ),
    "error that runs backwards": (
        f"{{ratio: 100, kinematic_error: {{amplitude: 6e-3}}, {ELASTIC}: {{linear: {{stiffness: 3}}}}}}",
        "kinematic error is too large: order * ratio * amplitude, in total 1.2, must not exceed 0.7:"
        " at 1 the drive would run backwards",
    ),
    "corners that fall together, with what is made of the spring": (
        f"{{{ELASTIC}: {{catalogue: {{k1: 1, k2: 2, k3: 3, t1: 5, t2: 5}}}}, backlash: 1e-3, hysteresis: {{loss: 1}}}}",
        "compliance.catalogue.t2 5.0 N m must be above t1 5.0",
    ),
    "zero ratio of a wave generator": (
        f"{{ratio: 0, {ELASTIC}: {{flexspline: {{stiffness: 3, hardening: 1}},"
        " wave_generator: {stiffness: 6, hardening: 2}}, hysteresis: {loss: 1}}",
        "ratio 0 must not be zero: motor turns per joint turn, signed",
    ),
    "hysteresis that overflows": (
        f"{{{ELASTIC}: {{linear: {{stiffness: 1e300}}}}, hysteresis: {{loss: 1e200}}}}",
        "its drive has inf as stiffness; every number must be finite, in hysteresis",
    ),
    "hysteresis without spring": (
        "{hysteresis: {loss: 1e-3}}",
        "'hysteresis' needs an elastic drive, but 'compliance' is rigid",
    ),
    "backlash without spring": (
        "{compliance: rigid, backlash: 1e-3}",
        "'backlash' needs an elastic drive, but 'compliance' is rigid",
    ),
    "voltage limit without resistance": (
        "{motor: {torque_constant: 0.1, voltage_limit: 48}}",
        "motor.voltage_limit 48.0 V needs the resistance, ohm, as well",
    ),
    "friction that no load can move": (
        "{friction: {motor: {coulomb: 2, per_load: 0.8, asymmetry: 0.5}}}",
        "friction.motor.per_load 0.8 makes friction's share of the load 1.2:"
        " it must stay below 1, or no load could be moved",
    ),
    "half a wave": (
        f"{{kinematic_error: {{amplitude: 1e-4, order: 1.5}}, {ELASTIC}: {{linear: {{stiffness: 3}}}}}}",
        "kinematic_error.order 1.5 must be a whole number of waves per turn",
    ),
    "rotor without inertia": ("{rotor: {inertia: 0}}", "rotor.inertia 0.0 kg m2 must be positive"),
    "rotor's mass twice": (
        "{rotor: {inertia: 1e-5, mass: 0.4}}",
        "rotor.mass 0.4 kg counts only with 'in_link_inertia: false'; the link includes the rotor",
    ),
    "rotor's place in a link that holds it": (
        "{rotor: {inertia: 1e-5, in_link_inertia: true, position: -0.1}}",
        "rotor.position -0.1 m counts only with 'in_link_inertia: false'; the link includes the rotor",
    ),
    "rotor that no body can be": (
        "{rotor: {inertia: 1e-5, in_link_inertia: false, transverse: 4e-6}}",
        "rotor.transverse 4e-06 kg m2 must be at least half of inertia 1e-05,"
        " as for any body that is round about its axis",
    ),
    "negative mass": (
        "{rotor: {inertia: 1, in_link_inertia: false, mass: -1}}",
        "rotor.mass -1.0 kg must not be negative",
    ),
    "unknown coupling": (
        "{rotor: {inertia: 1, coupling: complete}}",
        "rotor.coupling 'complete' must be 'reduced' or 'full'",
    ),
    "damping without spring": (
        "{damping: 3}",
        "damping 3.0 N m s/rad needs an elastic drive; give it a compliance",
    ),
    "static below Coulomb": (
        "{friction: {link: {coulomb: 2, static: 1, stribeck_velocity: 0.1}}}",
        "friction.link.static 1.0 N m must not be below coulomb 2.0",
    ),
    "static below the catalogue's Coulomb": (
        "{catalogue: CSG-14-100, friction: {motor: {static: 1, stribeck_velocity: 0.1}}}",
        "friction.motor.static 1.0 N m must not be below coulomb 2.1; the catalogue's friction applies where the entry"
        " states none: state both",
    ),
    "static alone": (
        "{friction: {link: {static: 1}}}",
        "friction.link must state 'static' and 'stribeck_velocity' together",
    ),
    "no smoothing": (
        "{friction: {motor: {coulomb: 1, smoothing: 0}}}",
        "friction.motor.smoothing 0.0 rad/s must be positive",
    ),
    "Stribeck velocity": (
        "{friction: {link: {static: 1, stribeck_velocity: -1}}}",
        "friction.link.stribeck_velocity -1.0 rad/s must be positive",
    ),
    "negative Coulomb": ("{friction: {link: {coulomb: -1}}}", "friction.link.coulomb -1.0 N m must not be negative"),
    "gear and ratio": (
        "{ratio: 3, gear: {reduction: 100, fixed: flexspline}}",
        "has both 'ratio' and 'gear'; state one of them",
    ),
    "unknown part": (
        "{gear: {reduction: 100, fixed: wave_generator}}",
        "gear.fixed 'wave_generator' must be 'flexspline' or 'circular_spline'",
    ),
    "swapped limits": (
        "{limits: {position: [1, -1]}}",
        "limits.position [1.0, -1.0] must be [lower, upper] with lower < upper",
    ),
    "one limit": ("{limits: {position: [1]}}", "limits.position [1.0] must have at least 2 entries"),
    "three limits": ("{limits: {position: [1, 2, 3]}}", "limits.position [1.0, 2.0, 3.0] must have at most 2 entries"),
    "half a further wave": (
        "{motor: {torque_constant: 1, ripple: {amplitude: 0.1, order: 6, harmonics: [[0.5, 1e-3, 0]]}}}",
        "motor.ripple.harmonics [0.5, 0.001, 0.0] must have an order of at least 1 and an amplitude that is not"
        " negative",
    ),
    "limit that is no number": ("{limits: {position: [-1, b]}}", "limits.position.1 'b' must be a number"),
    "limits in a row": ("{limits: {position: 1}}", "limits.position 1.0 rad must be a list"),
    "yes for true": (
        "{rotor: {inertia: 1, in_link_inertia: yes}}",
        "rotor.in_link_inertia 'yes' must be true or false",
    ),
    "merge key": (
        "{<<: {ratio: 1}}",
        "unknown key '<<'; known keys: 'catalogue', 'ratio', 'gear', 'rotor', 'compliance', 'backlash',"
        " 'damping', 'hysteresis', 'kinematic_error', 'friction', 'motor', 'limits', 'ratings'",
    ),
}


@pytest.mark.parametrize("case", ENTRIES)
def test_a_wrong_entry_is_named_with_its_line(case: str) -> None:
    entry, message = ENTRIES[case]
    text = f"version: 1\ndrives:\n  elbow: {{ratio: 2}}\n  shoulder:\n    {entry}"
    assert refused(text) == f"joint 'shoulder': {message} (arm.yaml:5)"


TOO_LARGE = "YAML cannot be read: the number of a character (\\U) or of the version is too large"

FILES = {
    "elastic without rotor": (
        "version: 1\ndefaults:\n  compliance: {linear: {stiffness: 3}}\ndrives:\n  elbow: {ratio: 2}",
        "joint 'elbow': an elastic drive needs a rotor with a positive inertia, kg m2 (arm.yaml:5)",
    ),
    "unknown joint": (
        "version: 1\ndrives:\n  wrist: {ratio: 2}",
        "joint 'wrist': the robot has no such joint; there are: 'shoulder', 'elbow', 'lift' (arm.yaml:3)",
    ),
    "fixed joint": (
        "version: 1\ndrives:\n  flange_joint: {ratio: 2}",
        "joint 'flange_joint': it is fixed (or a link), but a drive needs a joint that moves (arm.yaml:3)",
    ),
    "units of a prismatic joint": (
        "version: 1\ndrives:\n  lift: {damping: -1}",
        "joint 'lift': damping -1.0 N s/m must not be negative (arm.yaml:3)",
    ),
    "gear on a prismatic joint": (
        "version: 1\ndrives:\n  lift: {gear: {reduction: 5, fixed: flexspline}}",
        "joint 'lift': 'gear' is for rotary joints; on a prismatic joint state 'ratio' in rad/m (arm.yaml:3)",
    ),
    "wrong default": (
        "version: 1\ndefaults:\n  damping: -1\ndrives:\n  elbow: {ratio: 2}",
        "joint 'elbow': damping -1.0 N m s/rad must not be negative (arm.yaml:3)",
    ),
    "no mapping": (
        "- 1",
        "drive file: [1.0] must be a mapping with keys from 'version', 'defaults', 'drives' (arm.yaml:1)",
    ),
    "entry without fields": (
        "version: 1\ndrives:\n  elbow: 3",
        "drive file: drives.elbow 3.0 must be a mapping of fields (arm.yaml:3)",
    ),
    "no version": ("drives: {}", "drive file: 'version' is missing: 1 for this format (arm.yaml:1)"),
    "other version": (
        "version: 2\ndrives: {}",
        "drive file: version 2 is unknown; this cutpoint reads version 1 (arm.yaml:1)",
    ),
    "no drives": (
        "version: 1",
        "drive file: 'drives' is missing: one entry per driven joint, by joint name (arm.yaml:1)",
    ),
    "defaults of nothing": (
        "version: 1\ndefaults: {ratio: 100}\ndrives: {}",
        "drive file: 'defaults' apply to joints that 'drives' names, but it names none; name the joints there, as in"
        " 'shoulder: {}' (arm.yaml:2)",
    ),
    "unknown section": (
        "version: 1\ndrivers: {}\ndrives: {}",
        "drive file: unknown key 'drivers'; known keys: 'version', 'defaults', 'drives'; did you mean 'drives'?"
        " (arm.yaml:2)",
    ),
    "no value": ("version: 1\ndrives:\n  elbow: {ratio: }", "drives.elbow.ratio has no value (arm.yaml:3)"),
    "a number with a comma on a line of its own": (
        "version: 1\ndrives:\n  elbow:\n    ratio: 1,000",
        "joint 'elbow': ratio '1,000' must be a number, written without commas (arm.yaml:4)",
    ),
    "a wave that is none": (
        "version: 1\ndrives:\n  elbow: {kinematic_error: {amplitude: 1e-4, harmonics: [[1, 2]]}}",
        "joint 'elbow': kinematic_error.harmonics.0 [1.0, 2.0] must be one entry of: further waves, each"
        " [order, amplitude, phase] (arm.yaml:3)",
    ),
    "a tab": (
        "version: 1\ndrives:\n\telbow: {ratio: 2}",
        "YAML cannot be read: found character '\\t' that cannot start any token; indent lines with spaces (arm.yaml:3)",
    ),
    "grease in kelvin": (
        "version: 1\ndrives:\n  elbow: {friction: {link: {viscous: 2, grease: {temperature: 313, thinning: 0.03}}}}",
        "joint 'elbow': temperature 313.0 must be above -273.15 and at most 200 deg C, not in kelvin, in"
        " link_friction.grease (arm.yaml:3)",
    ),
    "a ratio of no machine": (
        "version: 1\ndrives:\n  elbow: {ratio: 1e200}",
        "joint 'elbow': ratio 1e+200 must be between 1e-12 and 1e12 in magnitude, as in any machine (arm.yaml:3)",
    ),
    "a number with a comma": (
        "version: 1\ndrives:\n  elbow: {damping: 4,000}",
        "drives.elbow.000 has no value; in {} a comma ends a value: 4000, not 4,000 (arm.yaml:3)",
    ),
    "a key twice": ("version: 1\ndrives: {}\ndrives: {}", "key 'drives' is given twice (arm.yaml:3)"),
    "nothing": ("# only a comment", "YAML holds no values (arm.yaml)"),
    "second document": ("version: 1\ndrives: {}\n---\na: 1", "a second document (---) is not read (arm.yaml:3)"),
    "open bracket": (
        "version: 1\ndrives: {",
        "YAML cannot be read: expected the node content, but found '<stream end>' (arm.yaml:2)",
    ),
    "python object": (
        'version: 1\ndrives: !!python/object/apply:os.system ["true"]',
        "YAML tags ('tag:yaml.org,2002:python/object/apply:os.system') are not read, for safety;"
        " remove the tag (arm.yaml:2)",
    ),
    "harmless tag": (
        "version: !!int 1",
        "YAML tags ('tag:yaml.org,2002:int') are not read, for safety; remove the tag (arm.yaml:1)",
    ),
    "bomb of aliases": (
        "a: &a [1, 1]\nb: &b [*a, *a]",
        "YAML anchors and aliases (&, *) are not read, for safety; write the value out (arm.yaml:1)",
    ),
    "alias of nothing": (
        "version: 1\ndrives: *a",
        "YAML anchors and aliases (&, *) are not read, for safety; write the value out (arm.yaml:2)",
    ),
    "key that is a list": ("? [1]\n: 2", "a key must be plain text (arm.yaml:1)"),
    "depth": ("[" * 5000, "YAML is nested more than 16 deep, the limit (arm.yaml:1)"),
    "number of values": (
        "[" + "1," * 30000 + "]",
        "YAML holds more than 20,000 values, the limit (arm.yaml:1)",
    ),
    "control character": ("version: 1\n\a", "YAML cannot be read: character '\\x07' is not allowed (arm.yaml:2)"),
    "a character that there is not": ('version: 1\na: "\\U00110000"', f"{TOO_LARGE} (arm.yaml:2)"),
    "one far beyond": ('version: 1\na: "\\UFFFFFFFF"', f"{TOO_LARGE} (arm.yaml:2)"),
    "a version far beyond": (f"%YAML 1.{'1' * 5000}\n---\na: 1", f"{TOO_LARGE} (arm.yaml:1)"),
    "bytes that are no UTF-8": (b"version: 1\n\xff", "YAML must be UTF-8 text; save the file as UTF-8 (arm.yaml:2)"),
}


@pytest.mark.parametrize("case", FILES)
def test_a_wrong_file_is_refused_with_its_line(case: str) -> None:
    text, message = FILES[case]
    assert refused(text) == message


def test_what_follows_or_floats_has_no_drive() -> None:
    mimic = '<mimic joint="a"/>'
    hand = robot(link("base"), link("x"), link("y"), joint("a", "base", "x"), joint("b", "base", "y", inside=mimic))
    coupled = parse_urdf(hand, mimic="coupled")
    assert refused("version: 1\ndrives: {b: {}}", coupled) == (
        "joint 'b': it follows joint 'a'; give that joint the drive (arm.yaml:2)"
    )
    floating = parse_urdf(ARM, floating_base=True)
    assert refused("version: 1\ndrives: {root_joint: {}}", floating) == (
        "joint 'root_joint': it is floating; a drive needs one of revolute, continuous, prismatic (arm.yaml:2)"
    )


def test_a_file_that_is_absent_or_too_large_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match=r"absent\.yaml' does not exist"):
        load_drives(tmp_path / "absent.yaml", ROBOT)
    large = tmp_path / "large.yaml"
    large.write_bytes(b"#" * (MAXIMUM_BYTES + 1))
    with pytest.raises(ModelError, match="file is larger than 262,144 bytes, the limit"):
        load_drives(large, ROBOT)
