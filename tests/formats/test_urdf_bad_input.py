"""Wrong and hostile URDF documents: one clear error each, with thing, value, rule and line."""

import re
from pathlib import Path

import pytest
from urdf_text import joint, link, robot

from cutpoint.errors import ModelError
from cutpoint.formats import load_urdf, parse_urdf
from cutpoint.formats.safe_xml import MAXIMUM_ATTRIBUTE, MAXIMUM_BYTES, MAXIMUM_DEPTH, MAXIMUM_ELEMENTS


def arm(element: str, inside: str = "", kind: str = "revolute") -> str:
    """A base, the element on line 3, and the joint `elbow` to it on line 4."""
    return robot(link("base"), element, joint("elbow", "base", "arm", kind, inside))


def refused(text: str | bytes) -> str:
    with pytest.raises(ModelError) as caught:
        parse_urdf(text, "arm.urdf")
    return str(caught.value)


LINKS = {
    "negative mass": (link("arm", -1.0), "link 'arm': mass -1.0 kg must not be negative (arm.urdf:3)"),
    "mass that is no number": (
        link("arm", "nan"),
        "link 'arm': <mass> value 'nan' must be a finite number (arm.urdf:3)",
    ),
    "mass too large": (link("arm", "1e999"), "link 'arm': <mass> value '1e999' must be a finite number (arm.urdf:3)"),
    "mass of many digits": (
        link("arm", "9" * 1000),
        f"link 'arm': <mass> value '{'9' * 200}' must be a finite number (arm.urdf:3)",
    ),
    "number with ornaments": (
        link("arm", "1_0"),
        "link 'arm': <mass> value '1_0' must be a finite number (arm.urdf:3)",
    ),
    "no mass value": (link("arm", ""), "link 'arm': <mass> has nothing in the attribute 'value' (arm.urdf:3)"),
    "triangle inequality": (
        link("arm", 1.0, (1.0, 0.1, 0.1)),
        "link 'arm': principal moments of inertia 0.1, 0.1, 1 kg m2: the largest exceeds the sum of the others by"
        " 80.00% of itself (triangle inequality); check <inertia> and its <origin>; increasing ixx, iyy and izz by"
        " 0.8008 would do; mend_inertia=True does that (--mend-inertia) (arm.urdf:3)",
    ),
    "negative moment": (
        link("arm", 1.0, (-0.1, 0.1, 0.1)),
        "link 'arm': principal moments of inertia -0.1, 0.1, 0.1 kg m2: none must be negative;"
        " check <inertia> and its <origin>; increasing ixx, iyy and izz by 0.1001 would do;"
        " mend_inertia=True does that (--mend-inertia) (arm.urdf:3)",
    ),
    "inertia without mass": (
        link("arm", 0),
        "link 'arm': principal moments of inertia 0.1, 0.1, 0.1 kg m2: without mass (0 kg) there is no inertia;"
        " state the mass or leave out <inertial> (arm.urdf:3)",
    ),
    "mass beyond machines": (
        link("arm", "1e300"),
        "link 'arm': mass must not exceed 1e+12 in SI units, beyond any machine, got 1e+300; check its"
        " unit (arm.urdf:3)",
    ),
    "no inertial": (
        link("arm", None),
        "link 'arm': moves with joint 'elbow' but has no mass and carries none; give it an <inertial> (arm.urdf:3)",
    ),
    "a tip without inertial": (
        link("arm") + link("tip", None) + joint("wrist", "arm", "tip", "revolute"),
        "link 'tip': moves with joint 'wrist' but has no mass and carries none; give it an <inertial>, or hold the"
        " joint: lock={'wrist': 0.0} (--lock wrist=0) (arm.urdf:3)",
    ),
    "inertial without tensor": (
        '<link name="arm"><inertial><mass value="1"/></inertial></link>',
        "link 'arm': <inertial> needs an element <inertia> (arm.urdf:3)",
    ),
    "two inertials": (
        '<link name="arm"><inertial/>\n<inertial/></link>',
        "link 'arm': has 2 <inertial>; at most one is allowed (arm.urdf:4)",
    ),
    "angle in degrees": (
        link("arm", origin='<origin rpy="0 90 0"/>'),
        "link 'arm': <origin> rpy '0 90 0' looks like degrees; URDF angles are radians (arm.urdf:3)",
    ),
}

JOINTS = {
    "no axis": ('<axis xyz="0 0 0"/>', "joint 'elbow': axis [0. 0. 0.] has no length; give it a direction"),
    "axis for xacro": (
        '<axis xyz="0 $(optenv Y 1) 0"/>',
        "joint 'elbow': <axis> xyz '0 $(optenv Y 1) 0' must be three finite numbers; it is for xacro to compute: give"
        " the file the ending .xacro",
    ),
    "decimal comma": (
        '<axis xyz="0 0,5 1"/>',
        "joint 'elbow': <axis> xyz '0 0,5 1' must be three finite numbers; use no commas: decimals have a point, and"
        " blanks separate numbers",
    ),
    "short axis": ('<axis xyz="0 1"/>', "joint 'elbow': <axis> xyz '0 1' must be three finite numbers"),
    "swapped limits": (
        '<limit lower="1" upper="-1"/>',
        "joint 'elbow': lower limit 1.0 must not exceed upper limit -1.0 rad; exchange them, or leave both out for no"
        " limit",
    ),
    "nan limit": ('<limit upper="nan"/>', "joint 'elbow': <limit> upper 'nan' must be a number, inf or -inf"),
    "empty limit": ('<limit velocity=" "/>', "joint 'elbow': <limit> has nothing in the attribute 'velocity'"),
    "negative effort": (
        '<limit effort="-5"/>',
        "joint 'elbow': effort limit -5.0 N m must not be negative; leave it out or state inf for no limit",
    ),
    "negative damping": ('<dynamics damping="-1"/>', "joint 'elbow': damping -1.0 N m s/rad must not be negative"),
    "angle in degrees": (
        '<origin rpy="0 90 0"/>',
        "joint 'elbow': <origin> rpy '0 90 0' looks like degrees; URDF angles are radians",
    ),
    "quaternion and angles": (
        '<origin rpy="0 0 0" quat_xyzw="0 0 0 1"/>',
        "joint 'elbow': <origin> states both rpy and quat_xyzw; leave one out",
    ),
    "quaternion without direction": (
        '<origin quat_xyzw="0 0 0 0"/>',
        "joint 'elbow': <origin> quat_xyzw '0 0 0 0' must be four finite numbers, not all zero",
    ),
    "short quaternion": (
        '<origin quat_xyzw="0 0 1"/>',
        "joint 'elbow': <origin> quat_xyzw '0 0 1' must be four finite numbers, not all zero",
    ),
    "mimic of itself": ('<mimic joint="elbow"/>', "joint 'elbow': mimics in a circle, through joint 'elbow'"),
}

KINDS = "'fixed', 'revolute', 'continuous', 'prismatic', 'planar', 'floating'"

DOCUMENTS = {
    "loop": (
        robot(link("base"), link("a"), link("b"), joint("j", "a", "b"), joint("k", "b", "a")),
        "joint 'k': closes a loop of links, 'a' -> 'b' -> 'a'; the links of a robot must form a tree (arm.urdf:6)",
    ),
    "loop without a root": (
        robot(link("a"), joint("j", "a", "a")),
        "joint 'j': closes a loop of links, 'a' -> 'a'; the links of a robot must form a tree (arm.urdf:3)",
    ),
    "two parents": (
        robot(link("base"), link("a"), joint("j", "base", "a"), joint("k", "base", "a")),
        "link 'a': is the child of two joints, 'j' and 'k'; a link has one parent"
        " (closed loops are not supported) (arm.urdf:3)",
    ),
    "two roots": (
        robot(link("base"), link("a")),
        "links 'base', 'a' have no parent joint; exactly one link, the root, may have none (arm.urdf:3)",
    ),
    "unknown link": (
        robot(link("base"), joint("j", "bse", "base")),
        "joint 'j': parent link 'bse' does not exist; there are: 'base' (arm.urdf:3)",
    ),
    "no world": (
        robot(link("base"), joint("j", "world", "base")),
        "joint 'j': parent link 'world' does not exist; there are: 'base'; add a link of that name, without mass"
        " (arm.urdf:3)",
    ),
    "another dialect": (
        robot(link("base"), link("a"), '<drake:joint xmlns:drake="http://drake.mit.edu" name="j" type="ball"/>'),
        "<joint> of the dialect 'http://drake.mit.edu' is not read, and the tree lacks it: state it in plain URDF"
        " (arm.urdf:4)",
    ),
    "a link twice": (
        robot(link("base"), link("base")),
        "link 'base': is defined 2 times; names must be unique (arm.urdf:3)",
    ),
    "no name": (robot("<link/>"), "link '': <link> needs the attribute 'name' (arm.urdf:2)"),
    "no links": (
        robot(),
        "the robot has no links; if the file only defines macros, give the one that calls them (arm.urdf)",
    ),
    "unknown joint": (
        arm(link("arm"), kind="screw"),
        f"joint 'elbow': type 'screw' is not supported; supported types: {KINDS} (arm.urdf:4)",
    ),
    "planar joint that mimics": (
        arm(link("arm"), '<mimic joint="elbow"/>', kind="planar"),
        "joint 'elbow': mimics joint 'elbow', but is planar;"
        " a follower must be one of revolute, continuous, prismatic, helical (arm.urdf:4)",
    ),
    "no child": (
        robot(link("base"), '<joint name="j" type="fixed"><parent link="base"/></joint>'),
        "joint 'j': <joint> needs an element <child> (arm.urdf:3)",
    ),
    "another format": ("<mujoco/>", "the root element of a URDF is <robot>, got <mujoco> (an MJCF file) (arm.urdf:1)"),
    "open element": (
        "<robot>\n<link>\n</robot>",
        "XML is not well formed: mismatched tag, at column 3: close each element before its parent (arm.urdf:3)",
    ),
    "no XML": ("hello", "XML is not well formed: syntax error (arm.urdf:1)"),
    "bytes that are no UTF-8": (
        b"<robot>\xff</robot>",
        "XML is not well formed: not well-formed (invalid token), at column 8: write & as &amp; and < as &lt;, use no"
        " -- in comments and no control characters, and save the file as UTF-8 (arm.urdf:1)",
    ),
    "an encoding that is not read": (
        '<?xml version="1.0" encoding="gb2312"?><robot name="机械臂"/>'.encode("gb2312"),
        "XML cannot be decoded: multi-byte encodings are not supported; save the file as UTF-8, and declare no other"
        " encoding (arm.urdf)",
    ),
    "a file cut off": (
        "<robot>\n<link name='base'/>\n",
        "XML is not well formed: no element found, at column 1: the file ends, maybe cut off, before its root element"
        " is closed (arm.urdf:3)",
    ),
    "a comment cut off": (
        "<robot>\n<!-- </robot>",
        "XML is not well formed: unclosed token, at column 1: the file ends, maybe cut off, before the tag or comment"
        " that begins here is closed (arm.urdf:2)",
    ),
    "a declaration that is not first": (
        '\n<?xml version="1.0"?>\n<robot/>',
        "XML is not well formed: XML or text declaration not at start of entity, at column 1: remove everything"
        " before <?xml ...?>, even blank lines and comments (arm.urdf:2)",
    ),
    "a prefix that is not declared": (
        "<robot>\n<sensor:camera/></robot>",
        "XML is not well formed: unbound prefix, at column 1: declare the prefix in the root element, xmlns:"
        'prefix="...", or remove it (arm.urdf:2)',
    ),
    "quaternions in a file without them": (
        arm(link("arm"), '<origin quat_xyzw="0 0 0 1"/>').replace("1.2", "1.0"),
        '<origin> quat_xyzw is for files of version 1.2: state version="1.2" in <robot>, or rpy here (arm.urdf:4)',
    ),
    "billion laughs": (
        '<!DOCTYPE r [<!ENTITY a "ha"><!ENTITY b "&a;&a;">]>\n<robot>&b;</robot>',
        "XML with a document type (<!DOCTYPE>) is not read, for safety; remove it (arm.urdf:1)",
    ),
    "external entity": (
        '\n<!DOCTYPE r [<!ENTITY a SYSTEM "file:///etc/passwd">]>\n<robot>&a;</robot>',
        "XML with a document type (<!DOCTYPE>) is not read, for safety; remove it (arm.urdf:2)",
    ),
    "depth": (
        "<a>\n" * (MAXIMUM_DEPTH + 1),
        "XML holds elements nested more than 499 deep, the limit (arm.urdf:500)",
    ),
}


@pytest.mark.parametrize("case", LINKS)
def test_a_wrong_link_is_named_with_its_line(case: str) -> None:
    element, message = LINKS[case]
    assert refused(arm(element)) == message


@pytest.mark.parametrize("case", JOINTS)
def test_a_wrong_joint_is_named_with_its_line(case: str) -> None:
    inside, message = JOINTS[case]
    assert refused(arm(link("arm"), inside)) == f"{message} (arm.urdf:4)"


@pytest.mark.parametrize(
    ("inside", "meant"),
    [
        ('<axsi xyz="0 1 0"/>', "<joint> holds <axsi>, which is not URDF; did you mean <axis>?"),
        ('<axes xyz="0 1 0"/>', "<joint> holds <axes>, which is not URDF; did you mean <axis>?"),
        ('<orign xyz="1 0 0"/>', "<joint> holds <orign>, which is not URDF; did you mean <origin>?"),
        ('<limits effort="5"/>', "<joint> holds <limits>, which is not URDF; did you mean <limit>?"),
        ('<Dynamics damping="5"/>', "<joint> holds <Dynamics>, which is not URDF; did you mean <dynamics>?"),
        ('<axis xzy="0 1 0"/>', "<axis> has the attribute 'xzy', which is not URDF; did you mean 'xyz'?"),
        ('<origin ryp="0 1 0"/>', "<origin> has the attribute 'ryp', which is not URDF; did you mean 'rpy'?"),
        ('<limit efort="5"/>', "<limit> has the attribute 'efort', which is not URDF; did you mean 'effort'?"),
        (
            '<dynamics dampning="5"/>',
            "<dynamics> has the attribute 'dampning', which is not URDF; .* you mean 'damping'?",
        ),
    ],
)
def test_slips_that_would_leave_another_robot_are_refused(inside: str, meant: str) -> None:
    pattern = re.escape(f"{meant} (arm.urdf:4)").replace(r"\.\*", ".*")
    assert re.fullmatch(pattern, refused(arm(link("arm"), inside)))


def test_other_names_are_passed_over() -> None:
    others = '<dynamics damping="2" frictionloss="1"/><safety_controller k_velocity="1"/><calibration rising="0"/>'
    body = link("arm").replace("<inertial>", "<visual><orign/></visual><inertial>")
    read = parse_urdf(arm(body, others))
    assert read.bodies[0].joint.damping == 2.0 and read.bodies[0].joint.friction == 0.0


@pytest.mark.parametrize("case", DOCUMENTS)
def test_a_wrong_document_is_refused_with_its_line(case: str) -> None:
    text, message = DOCUMENTS[case]
    assert refused(text) == message


def test_the_number_of_elements_is_capped() -> None:
    assert refused("<robot>" + "<a/>" * MAXIMUM_ELEMENTS).startswith("XML holds more than 200,000 elements")


def test_the_length_of_an_attribute_is_capped() -> None:
    text = robot(link("a" * (MAXIMUM_ATTRIBUTE + 1)))
    told = "XML holds 'name' of <link>, an attribute of 1,000,001 characters, more than 1,000,000, the limit"
    assert refused(text) == f"{told} (arm.urdf:2)"
    quoted = refused(robot(link("a" * MAXIMUM_ATTRIBUTE, "heavy")))
    assert len(quoted) < 25_000 and quoted.endswith("' must be a finite number (arm.urdf:2)")


def test_a_long_chain_needs_no_deep_stack() -> None:
    names = [f"l{i}" for i in range(3000)]
    joints = [joint(f"j{i}", f"l{i}", f"l{i + 1}") for i in range(2999)]
    assert len(parse_urdf(robot(*map(link, names), *joints)).bodies) == 2999


def test_an_error_keeps_its_evidence() -> None:
    with pytest.raises(ModelError) as caught:
        parse_urdf(arm(link("arm", -1.0)), "arm.urdf")
    assert caught.value.evidence["link"] == "arm"
    assert caught.value.evidence["mass"] == -1.0
    assert caught.value.place == "arm.urdf:3"


def test_paths_that_are_no_files_are_refused(tmp_path: Path) -> None:
    empty, large = tmp_path / "empty.urdf", tmp_path / "large.urdf"
    empty.touch()
    with large.open("wb") as file:
        file.truncate(MAXIMUM_BYTES + 1)
    rules = {
        tmp_path / "absent.urdf": "absent.urdf' does not exist",
        tmp_path: "is a directory; give the path of a file",
        empty: "file is empty (",
        large: "file is larger than 67,108,864 bytes, the limit (",
    }
    for path, rule in rules.items():
        with pytest.raises(ModelError, match=re.escape(rule)):
            load_urdf(path)
