"""MJCF files: the robot that is read moves as MuJoCo moves it; what is lost is listed; what is hostile is refused."""

import re
import sys
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mjcf_text
import mujoco
import numpy as np
import pytest
from mjcf_text import one_body
from scipy.linalg import block_diag
from scipy.spatial.transform import Rotation

import cutpoint
from cutpoint import Coulomb, Drive, Robot, Rotor
from cutpoint.errors import InputError, ModelError
from cutpoint.formats import DegreesWarning, NotCarriedOver, RenamedWarning, parse_mjcf
from cutpoint.formats.mjcf.text import MAXIMUM_PIECES
from cutpoint.loading import DroppedWarning
from cutpoint.model import Limits
from robot_library import Array, assert_close

PACKAGED = Path(mujoco.__file__).parent / "testdata" / "model.xml"

MODELS = {
    "arm": mjcf_text.ARM,
    "balls": mjcf_text.BALLS,
    "free": mjcf_text.FREE,
    "several joints in a body": mjcf_text.SEVERAL,
    "MuJoCo's own": PACKAGED.read_text(),
}


def read(text: str, backend: str = "numpy") -> Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NotCarriedOver)
        warnings.simplefilter("ignore", RenamedWarning)
        mechanism, drives = parse_mjcf(text)
    return Robot(mechanism, drives, backend=backend)  # pyright: ignore[reportArgumentType]


def bare_model(text: str) -> mujoco.MjModel:
    """MuJoCo's model, less what the warning lists: nothing but bodies, hinges' armature and gravity."""
    model = mujoco.MjModel.from_xml_string(text)
    off = mujoco.mjtDisableBit
    for bit in (off.mjDSBL_CONSTRAINT, off.mjDSBL_SPRING, off.mjDSBL_DAMPER, off.mjDSBL_ACTUATION):
        model.opt.disableflags |= bit
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    model.opt.density = model.opt.viscosity = 0.0
    model.body_gravcomp[:] = 0.0
    undriven = model.jnt_type[model.dof_jntid] < 2
    model.dof_armature[undriven] = 0.0
    return model


@dataclass
class Twin:
    """A robot and MuJoCo's model of it; both number joints depth first, in the file's order."""

    ours: Robot
    model: mujoco.MjModel

    def at(self, q: Array, v: Array, a: Array) -> tuple[Any, Array]:
        """MuJoCo's data at a state, and the matrix that takes our speeds to its."""
        data = mujoco.MjData(self.model)
        coordinates, turns, extra = [], [], np.zeros(self.ours.nv)
        for segment in self.ours.machine.system.segments:
            own, dof = q[segment.q], segment.v.start
            turns.append(np.eye(len(segment.joint.axes)))
            if len(own) == 7:
                turns[-1][:3, :3] = Rotation.from_quat(own[3:]).as_matrix()
                extra[dof : dof + 3] = turns[-1][:3, :3] @ np.cross(v[dof + 3 : dof + 6], v[dof : dof + 3])
            coordinates.append(own if len(own) < 4 else [*own[:-4], own[-1], *own[-4:-1]])
        T = block_diag(*turns)
        data.qpos[:], data.qvel[:], data.qacc[:] = np.concatenate(coordinates), T @ v, T @ a + extra
        return data, T


@pytest.fixture(params=MODELS)
def twin(request: pytest.FixtureRequest) -> Twin:
    text = MODELS[request.param]
    return Twin(read(text), bare_model(text))


def states(ours: Robot) -> tuple[Array, Array, Array]:
    """At rest unmoved, tiny, and at random."""
    rng, q = np.random.default_rng(3), ours.random(3, 5)
    v, a = rng.normal(0.0, 2.0, (2, 5, ours.nv))
    q[0], v[0], a[0] = ours.neutral(), 0.0, 0.0
    q[1], v[1], a[1] = ours.integrate(ours.neutral(), v[1], 1e-9), 1e-9 * v[1], 1e-9 * a[1]
    return q, v, a


def each(twin: Twin) -> Any:
    q, v, a = states(twin.ours)
    return [(k, *twin.at(q[k], v[k], a[k])) for k in range(len(q))]


def test_inverse_dynamics_is_mujocos(twin: Twin) -> None:
    tau = twin.ours.inverse_dynamics(*states(twin.ours))
    for k, data, T in each(twin):
        mujoco.mj_inverse(twin.model, data)
        assert_close(tau[k], T.T @ data.qfrc_inverse)


def test_forward_dynamics_is_mujocos(twin: Twin) -> None:
    q, v, tau = states(twin.ours)
    found = twin.ours.forward_dynamics(q, v, tau)
    for k, data, T in each(twin):
        data.qfrc_applied[:] = T @ tau[k]
        mujoco.mj_forward(twin.model, data)
        at_rest, _ = twin.at(q[k], v[k], np.zeros_like(v[k]))
        assert_close(found[k], T.T @ (data.qacc - at_rest.qacc))


def test_mass_matrix_and_energies_are_mujocos(twin: Twin) -> None:
    """Potential energy but for that of bodies at rest, which have no mass here."""
    q, v, _ = states(twin.ours)
    M, kinetic, potential = twin.ours.mass_matrix(q), twin.ours.kinetic_energy(q, v), twin.ours.potential_energy(q)
    theirs = []
    for k, data, T in each(twin):
        mujoco.mj_forward(twin.model, data)
        full = np.zeros((twin.model.nv, twin.model.nv))
        mujoco.mj_fullM(twin.model, data, full)
        assert_close(M[k], T.T @ full @ T)
        assert_close(kinetic[k], data.energy[1])
        theirs.append(data.energy[0])
    weight = 10.0 * twin.model.body_mass.sum()
    assert_close(potential - potential[0], np.array(theirs) - theirs[0], 1e-12, scale=weight)


def test_every_body_is_where_mujoco_has_it(twin: Twin) -> None:
    q, _, _ = states(twin.ours)
    for k, data, _ in each(twin):
        mujoco.mj_kinematics(twin.model, data)
        for b in range(1, twin.model.nbody):
            pose = twin.ours.frame_pose(q[k], twin.model.body(b).name or f"body_{b}")
            assert_close(pose[:3, 3], data.xpos[b], 1e-12, scale=1.0)
            assert_close(pose[:3, :3], data.xmat[b].reshape(3, 3), 1e-12)


@pytest.mark.filterwarnings("ignore::cutpoint.formats.NotCarriedOver")
def test_the_neutral_configuration_is_zero_whatever_a_file_says_of_its_start() -> None:
    at_start = '<keyframe><key qpos="0.3"/></keyframe>'
    bent = one_body("", at_start).replace("<joint", '<joint range="20 90" ref="35"')
    assert read(bent).neutral() == [0.0]
    np.testing.assert_array_equal(read(mjcf_text.BALLS).neutral(), [0, 0, 0, 1] * 2)


def test_names_that_are_made_keep_clear_of_the_files_own() -> None:
    twin = Twin(read(mjcf_text.TAKEN), bare_model(mjcf_text.TAKEN))
    assert twin.ours.joints == ("joint_2", "joint_2_", "joint_2__", "joint_3", "body_2__fixed")
    assert {"body_2_after_joint_2_", "body_2_"} <= set(twin.ours.frames)
    tau = twin.ours.inverse_dynamics(*states(twin.ours))
    for k, data, T in each(twin):
        mujoco.mj_inverse(twin.model, data)
        assert_close(tau[k], T.T @ data.qfrc_inverse)


def test_compiled_code_agrees_with_mujoco() -> None:
    ours = Twin(read(mjcf_text.SEVERAL, "llvm"), bare_model(mjcf_text.SEVERAL))
    tau = ours.ours.inverse_dynamics(*states(ours.ours))
    for k, data, T in each(ours):
        mujoco.mj_inverse(ours.model, data)
        assert_close(tau[k], T.T @ data.qfrc_inverse)


def test_a_chain_as_deep_as_mujoco_reads_needs_no_deep_stack(tmp_path: Path) -> None:
    count = 496
    link = '<body pos="0 0 0.1"><joint axis="0 1 0"/><geom size="0.02" mass="0.1"/>'
    chain = f"<mujoco><worldbody>{link * count}{'</body>' * count}</worldbody></mujoco>"
    (path := tmp_path / "chain.xml").write_text(chain)
    with pytest.warns(NotCarriedOver, match="contacts"):
        assert cutpoint.load(path).nv == mujoco.MjModel.from_xml_path(str(path)).nv == count


def test_limits_friction_and_armature_are_the_joints() -> None:
    arm = read(mjcf_text.ARM)
    shoulder, elbow, lift = (body.joint for body in arm.mechanism.bodies)
    assert [joint.kind for joint in (shoulder, elbow, lift)] == ["revolute", "continuous", "prismatic"]
    assert shoulder.limits == Limits(np.deg2rad(-100), np.deg2rad(120), effort=20.0)
    assert lift.limits == Limits(-0.1, 0.5)
    assert (elbow.damping, elbow.friction, elbow.limits) == (0.4, 0.2, Limits())
    assert arm.drives["shoulder"].rotor == arm.drives["lift"].rotor == Rotor(0.7)
    assert arm.drives["elbow"].rotor is None
    np.testing.assert_array_equal(arm.gravity, [0.3, -0.2, -9.7])
    assert arm.name == "arm"


@pytest.mark.filterwarnings("ignore::cutpoint.formats.NotCarriedOver")
@pytest.mark.parametrize("ending", ["xml", "mjcf"])
def test_a_drive_file_comes_before_the_armature(tmp_path: Path, ending: str) -> None:
    robot, drives = tmp_path / f"arm.{ending}", tmp_path / "arm.drives.yaml"
    robot.write_text(mjcf_text.ARM)
    drives.write_text("version: 1\ndrives: {shoulder: {ratio: 50, rotor: {inertia: 1e-5}}}")
    told = (
        r"the robot file's damping and friction of 'shoulder' are ignored, since a drive's entry replaces them: .*arm"
    )
    with pytest.warns(DroppedWarning, match=told):
        arm = cutpoint.load(robot, drives, lock={"elbow": 0.1}, gravity=(0, 0, -1.6))
    assert arm.drives["shoulder"] == Drive(50.0, Rotor(1e-5))
    assert arm.drives["lift"].rotor == Rotor(0.7)
    assert isinstance(arm.drives["lift"].link_friction, Coulomb)
    assert arm.joints == ("shoulder", "lift")
    assert arm.gravity[2] == -1.6


@pytest.mark.parametrize("bodies", ["", '<body name="rack"><geom size="1" contype="0" conaffinity="0"/></body>'])
def test_a_document_without_joints_is_a_robot_that_stands(bodies: str) -> None:
    robot, drives = parse_mjcf(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")
    assert (robot.bodies, drives) == ((), {})
    assert set(robot.frames) >= {"world"} | ({"rack"} if bodies else set())


def test_gravity_that_is_switched_off_is_off() -> None:
    off = '<option><flag gravity="disable" contact="disable"/></option>'
    np.testing.assert_array_equal(read(one_body("", off)).gravity, np.zeros(3))


SHAPE = '<asset><mesh name="rock" file="/etc/passwd"/></asset>'

LOST = {
    "nothing": (one_body('<site name="s"/><camera/><light/>', "<sensor/><visual/>"), ()),
    "sections without elements": (one_body("", "<actuator/><contact/><equality/><extension/><tendon/>"), ()),
    "actuators": (
        one_body("", '<actuator><motor joint="elbow"/><motor joint="elbow"/></actuator>'),
        ("<actuator> (2)",),
    ),
    "tendons and constraints": (
        one_body(
            "",
            '<tendon><fixed><joint joint="elbow" coef="1"/></fixed></tendon>'
            '<equality><joint joint1="elbow"/></equality>',
        ),
        ("<equality> (1)", "<tendon> (1)"),
    ),
    "contacts": (
        one_body('<geom size="1"/><geom size="1" contype="0" conaffinity="0"/>'),
        ("contacts (1 geoms)",),
    ),
    "fluid": (one_body("", '<option density="1.2" viscosity="1e-5"/>'), ("fluid forces",)),
    "gravcomp": (one_body("", attributes='gravcomp="1"'), ("gravcomp of bodies 'arm'",)),
    "reversed range": (
        one_body("", '<default><joint range="90 -90"/></default>'),
        ("reversed range, which MuJoCo takes for none, of joints 'elbow'",),
    ),
    "springs": (one_body("", '<default><joint stiffness="3"/></default>'), ("springs of joints 'elbow'",)),
    "of balls": (
        one_body(
            '<body name="b"><joint name="ball" type="ball" damping="1" frictionloss="2" armature="3" range="0 1"/>'
            '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body>'
        ),
        (
            "damping of joints 'ball'",
            "frictionloss of joints 'ball'",
            "armature, in the mass matrix, of joints 'ball'",
            "range of joints 'ball'",
        ),
    ),
    "what is not known": (one_body("<novelty/>"), ("<novelty> (1)",)),
    "a shape from a file": (one_body('<geom type="mesh" mesh="rock"/>', SHAPE), ("contacts (1 geoms)",)),
}


@pytest.mark.parametrize("case", LOST)
def test_what_is_lost_is_listed_once(case: str) -> None:
    text, things = LOST[case]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        parse_mjcf(text, "arm.xml")
    found = [warning.message for warning in caught]
    assert [getattr(message, "things", None) for message in found] == ([things] if things else [])
    for message in found:
        assert str(message) == f"not carried over: {'; '.join(things)} (arm.xml)"


BUILT = '<asset><mesh name="rock" builtin="sphere" params="30"/></asset>'
MASSLESS = one_body('<body name="tip"><joint/><geom type="mesh" mesh="rock"/></body>', SHAPE)
SAFETY = "is not read, for safety: it stands for text that is not in this file; let MuJoCo write all of it"
ELSEWHERE = (
    "its inertia would come from a shape that is not in this file; give it an <inertial>; MuJoCo writes one if "
    "MjSpec.compiler.saveinertial is true"
)
NO_FOLDER = "<include> is not read from text in memory, which has no folder; give the file's path"

REFUSED = {
    "include": (one_body('<include file="a.xml"/>'), f"{NO_FOLDER} (arm.xml:3)"),
    "include in a section": (one_body("", '<asset><include file="a"/></asset>'), f"{NO_FOLDER} (arm.xml:1)"),
    "attach": (one_body('<attach model="m" body="b" prefix="p"/>'), f"<attach> {SAFETY} .* (arm.xml:3)"),
    "replicate": (one_body('<replicate count="1000000000"/>'), f"<replicate> {SAFETY} .* (arm.xml:3)"),
    "composite": (one_body('<composite type="cable" count="99999 1 1"/>'), f"<composite> {SAFETY} .* (arm.xml:3)"),
    "flexcomp": (one_body('<flexcomp type="gmsh" file="/dev/zero"/>'), f"<flexcomp> {SAFETY} .* (arm.xml:3)"),
    "entities": (
        '<!DOCTYPE m [<!ENTITY a SYSTEM "file:///etc/passwd">]><mujoco>&a;</mujoco>',
        "XML with a document type (<!DOCTYPE>) is not read, for safety; remove it (arm.xml:1)",
    ),
    "a URDF": (
        "\n<robot/>",
        "the root element of an MJCF file is <mujoco>, got <robot> (a URDF file; its ending is .urdf) (arm.xml:2)",
    ),
    "a part": (
        "<mujocoinclude/>",
        "the root element of an MJCF file is <mujoco>, got <mujocoinclude> (a part: give the file that includes it)"
        " (arm.xml:1)",
    ),
    "a part whose root is none": (
        '<mujoco>\n<body name="hand"/></mujoco>',
        "<body> outside <worldbody>: this file is a part, give the file that includes it (arm.xml:2)",
    ),
    "a part without bodies": (
        "<mujoco><sensor/></mujoco>",
        "there is no <worldbody>: this file is a part, give the file that includes it (arm.xml:1)",
    ),
    "nan": (one_body('\n<geom pos="0 NaN 0" size="1"/>'), "<geom> pos '0 NaN 0' must not contain nan (arm.xml:4)"),
    "a misspelt attribute": (
        one_body('\n\n<geom sise="1"/>'),
        "MuJoCo cannot compile this file: XML Error: Schema violation: unrecognized attribute: 'sise'"
        " Element 'geom', line 5 (arm.xml)",
    ),
    "a misspelt element": (
        one_body('\n<Body name="tip"/>'),
        "<body> holds <Body>, which is not MJCF; did you mean <body>? (arm.xml:4)",
    ),
    "an element of URDF": (
        one_body("<inertia/>"),
        "<body> holds <inertia>, which is not MJCF; did you mean <inertial>? (arm.xml:3)",
    ),
    "an axis without length": (
        one_body('<joint axis="0 0 0"/>'),
        "MuJoCo cannot compile this file: Error: axis too small in joint .* (arm.xml)",
    ),
    "a quaternion too long to square": (
        one_body('<body name="tip" quat="1e200 0 1e200 0"><joint/><geom size="1"/></body>'),
        "body 'tip': its quat gives MuJoCo no direction; use one of length 1",
    ),
    "inertia of a shape from a file": (
        MASSLESS,
        f"body 'tip': {ELSEWHERE} (arm.xml:3)",
    ),
    "inertia of a shape that MuJoCo builds": (
        one_body('<body name="tip"><joint/><geom type="mesh" mesh="rock"/></body>', BUILT),
        f"body 'tip': {ELSEWHERE} (arm.xml:3)",
    ),
    "inertia of a shape from a file, of a body without a name": (
        MASSLESS.replace('name="tip"', ""),
        f"a body without a name: {ELSEWHERE} (arm.xml:3)",
    ),
    "negative armature": (
        one_body("").replace('name="elbow"', 'name="elbow" armature="-1"'),
        "joint 'elbow': armature -1 kg m2 must not be negative (arm.xml)",
    ),
    "two names": (
        one_body('<body name="arm"/>'),
        "MuJoCo cannot compile this file: .*repeated name 'arm' in body.* (arm.xml)",
    ),
    "too many": (
        one_body("<geom/>" * (MAXIMUM_PIECES // 2)),
        "MJCF holds more than 20,000 bodies, joints and geoms, the limit (arm.xml:3)",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_wrong_or_hostile_is_refused(case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    text, message = REFUSED[case]
    with pytest.raises(ModelError) as caught:
        parse_mjcf(text, "arm.xml")
    assert re.fullmatch(re.escape(message).replace(r"\.\*", ".*"), str(caught.value)), str(caught.value)
    assert not list(tmp_path.iterdir())  # MuJoCo writes its warnings to a file


ABSENT = (
    '<asset><mesh name="rock" file="r.stl"/><hfield name="h" file="h.png"/><texture name="t" file="t.png"/></asset>'
)
GROUND = '<geom type="hfield" hfield="h"/><body><geom type="mesh" mesh="rock"/></body>'

UNNEEDED = {
    "stated inertia": one_body('<geom type="mesh" mesh="rock"/>', ABSENT),
    "stated mass of nothing": one_body('<body><geom size="1"/><geom type="mesh" mesh="rock" mass="0"/></body>', ABSENT),
    "out of the inertia's groups": one_body(
        '<body><geom size="1"/><geom type="mesh" mesh="rock" group="2"/></body>',
        ABSENT + '<compiler inertiagrouprange="0 1"/>',
    ),
    "bodies at rest": one_body("").replace("<worldbody>", f"{ABSENT}<worldbody>{GROUND}"),
}


@pytest.mark.filterwarnings("ignore::cutpoint.formats.NotCarriedOver")
@pytest.mark.parametrize("case", UNNEEDED)
def test_shapes_that_dynamics_does_not_need_are_never_opened(case: str) -> None:
    robot, _ = parse_mjcf(UNNEEDED[case])
    assert [body.joint.name for body in robot.bodies] == ["elbow"]


def test_losses_that_the_file_switches_off_are_none() -> None:
    hinge = '<joint name="elbow" damping="3" frictionloss="2"/><geom size="0.1" mass="1"/>'
    text = f"<mujoco><option><flag {{}}/></option><worldbody><body>{hinge}</body></worldbody></mujoco>"
    lossy = {
        'contact="enable"': (3.0, 2.0),
        'damper="disable"': (0.0, 2.0),
        'frictionloss="disable"': (3.0, 0.0),
        'constraint="disable"': (3.0, 0.0),
    }
    for flags, (damping, friction) in lossy.items():
        (body,) = read(text.format(flags)).mechanism.bodies
        assert (body.joint.damping, body.joint.friction) == (damping, friction)


@pytest.mark.parametrize("flag", ["contact", "constraint"])
def test_contacts_that_the_file_switches_off_are_not_told(flag: str) -> None:
    text = one_body('<geom size="1"/>', f'<option><flag {flag}="{{}}"/></option>')
    with pytest.warns(NotCarriedOver, match="contacts"):
        parse_mjcf(text.format("enable"))
    parse_mjcf(text.format("disable"))


def test_armature_of_what_is_left_out_is_told() -> None:
    text = mjcf_text.ARM.replace("</mujoco>", '<actuator><motor joint="hip" armature="2"/></actuator></mujoco>')
    with pytest.warns(NotCarriedOver, match=r"<actuator> armature, in the mass matrix \(1\)"):
        parse_mjcf(text)


@pytest.mark.parametrize("tag", ["motor", "tendon"])
def test_armature_of_what_is_left_out_is_told_where_a_default_states_it(tag: str) -> None:
    section = '<actuator><motor joint="hip"/></actuator>' if tag == "motor" else "<tendon><fixed name='t'/></tendon>"
    default = f'<default><{tag} armature="0.3"/></default>'
    text = mjcf_text.ARM.replace("</mujoco>", f"{default}{section}</mujoco>")
    section = "actuator" if tag == "motor" else "tendon"
    with pytest.warns(NotCarriedOver, match=rf"<{section}> armature, in the mass matrix \(1\)"):
        parse_mjcf(text)


def test_an_infinite_place_is_refused_where_it_stands() -> None:
    text = mjcf_text.ARM.replace("</worldbody>", '<body pos="inf 0 0"/></worldbody>')
    with pytest.raises(ModelError, match=r"<body> pos 'inf 0 0' must be finite \(<string>:\d+\)"):
        parse_mjcf(text)


def test_efforts_that_are_not_alike_to_both_sides_are_told() -> None:
    text = mjcf_text.one_body("").replace('<joint name="elbow"/>', '<joint name="elbow" actuatorfrcrange="{}"/>')
    for ends, effort in (("0 5", 0.0), ("-3 5", 3.0)):
        with pytest.warns(NotCarriedOver, match=r"asymmetric actuatorfrcrange .* of joints 'elbow'"):
            (body,) = parse_mjcf(text.format(ends)).mechanism.bodies
        assert body.joint.limits.effort == effort


def test_a_total_mass_needs_every_shape() -> None:
    """It scales all masses, so that of a body at rest counts."""
    text = one_body("").replace("<worldbody>", f'<compiler settotalmass="9"/>{ABSENT}<worldbody>{GROUND}')
    with pytest.raises(ModelError, match="its inertia would come from a shape that is not in this file"):
        parse_mjcf(text)


@pytest.mark.filterwarnings("ignore:MuJoCo says")  # that settotalmass is deprecated
def test_a_total_mass_that_would_leave_out_what_is_fused_to_the_world_is_refused() -> None:
    """MuJoCo does not scale by the mass of bodies that it makes a part of the world; here they stay bodies."""
    text = one_body("").replace("<worldbody>", '<compiler settotalmass="9" fusestatic="true"/><worldbody>')
    (alone,) = read(text).mechanism.bodies
    np.testing.assert_allclose(alone.mass, bare_model(text).body_mass[-1])
    beside = text.replace("<body", '<body name="post"><geom size="0.1" mass="2"/></body><body', 1)
    told = r"with fusestatic=\"true\" bodies 'post' become part of .* settotalmass would not count .*: leave fusestatic"
    with pytest.raises(ModelError, match=told):
        parse_mjcf(beside)
    counted = beside.replace('fusestatic="true"', 'fusestatic="false"')
    (arm,) = read(counted).mechanism.bodies
    np.testing.assert_allclose(arm.mass, bare_model(counted).body_mass[-1])


@pytest.mark.parametrize(("compiler", "joint"), [('alignfree="true"', ""), ("", 'align="true"')])
def test_a_free_body_that_is_aligned_only_once_others_are_fused_to_it_is_refused(compiler: str, joint: str) -> None:
    tip = '<body name="tip" pos="1 0 0"><geom size="0.1"/>{}</body>'
    text = f"""<mujoco><compiler fusestatic="true" {compiler}/><worldbody><body name="stone"><freejoint {joint}/>
      <geom type="box" size="0.1 0.2 0.3" pos="0.5 0.1 0" euler="10 20 30"/>{tip}</body></worldbody></mujoco>"""
    with pytest.raises(ModelError, match=r"bodies 'tip' become part of .*, and align would move the frame of 'stone'"):
        parse_mjcf(text.format(""))
    for kept in (text.format('<body><joint/><geom size="0.1"/></body>'), text.replace(tip, "")):
        model = bare_model(kept)
        data = mujoco.MjData(model)
        data.qpos[:7] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
        mujoco.mj_inverse(model, data)
        robot = read(kept)
        assert_close(robot.gravity_forces(robot.neutral()), data.qfrc_inverse)


SITES = """<mujoco><default><default class="tool"><site euler="0 90 0" size="0.01"/></default></default><worldbody>
  <site name="bench" pos="1 2 3"/>
  <body name="arm"><joint name="elbow" axis="0 1 0"/>
    <geom size="0.1" mass="1" contype="0" conaffinity="0"/>
    <site name="arm" pos="0.1 0 0"/><site name="flange" class="tool" pos="0.2 0 0.3"/><site pos="9 9 9"/>
    <body name="hand" pos="0 0 1"><site name="finger" pos="0 1 0"/><site name="hand_fixed"/></body>
    <site name="elbow" pos="0 0.3 0"/><site name="arm_site" pos="0 0 0.4"/>
  </body>
</worldbody></mujoco>"""

OF_SITES = {
    "bench": "bench",
    "arm": "arm_site_",
    "flange": "flange",
    "finger": "finger",
    "hand_fixed": "hand_fixed",
    "elbow": "elbow_site",
    "arm_site": "arm_site",
}


@pytest.mark.filterwarnings("ignore::cutpoint.formats.RenamedWarning")
def test_sites_are_frames_and_take_none_from_bodies_and_joints() -> None:
    robot, model = cutpoint.Robot(parse_mjcf(SITES).mechanism), mujoco.MjModel.from_xml_string(SITES)
    data, q = mujoco.MjData(model), np.array([0.7])
    data.qpos[:] = q
    mujoco.mj_forward(model, data)
    for site, frame in OF_SITES.items():
        found = robot.frame_pose(q, frame)
        np.testing.assert_allclose(found[:3, 3], data.site(site).xpos, rtol=0, atol=1e-15)
        np.testing.assert_allclose(found[:3, :3].reshape(-1), data.site(site).xmat, rtol=0, atol=1e-15)
    for frame, body in {"arm": "arm", "elbow": "arm", "hand": "hand", "world": "world"}.items():
        np.testing.assert_allclose(robot.frame_pose(q, frame)[:3, 3], data.body(body).xpos, rtol=0, atol=1e-15)


def test_a_site_with_the_name_of_a_body_or_joint_is_renamed_and_said() -> None:
    with pytest.warns(RenamedWarning) as caught:
        parse_mjcf(SITES, "arm.xml")
    (told,) = caught
    own = "sites 'arm', 'elbow' are the frames 'arm_site_', 'elbow_site', since bodies or joints have those names"
    assert str(told.message) == f"{own} (arm.xml)"


def test_many_renamed_sites_are_told_in_short() -> None:
    """As of a humanoid whose every body has a site of its name."""
    body = '<body name="b{0}"><joint/><geom size="0.1" contype="0" conaffinity="0"/><site name="b{0}"/></body>'
    rule = r"sites 'b0', .* \(30 in all\), 'b29' are the frames 'b0_site', .*, 'b29_site', since bodies or joints .*"
    with pytest.warns(RenamedWarning, match=rule) as caught:
        parse_mjcf(f"<mujoco><worldbody>{''.join(map(body.format, range(30)))}</worldbody></mujoco>")
    assert max(len(str(told.message)) for told in caught) < 400


@pytest.mark.filterwarnings("ignore::cutpoint.formats.RenamedWarning")
def test_frames_are_those_that_the_file_names() -> None:
    frames = parse_mjcf(SITES).mechanism.frames
    assert set(frames) == {"world", "arm", "elbow", "hand", *OF_SITES.values()}


def test_what_mujoco_remarks_is_told_with_the_file() -> None:
    text = one_body("").replace("<worldbody>", '<compiler settotalmass="9"/><worldbody>')
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        parse_mjcf(text, "arm.xml")
    assert all(str(each.message).startswith("MuJoCo says about arm.xml: ") for each in caught)
    assert all(Path(each.filename).name != "model.py" for each in caught)


def test_ranges_that_look_like_degrees_are_warned_of() -> None:
    text = one_body('<joint name="wrist" axis="0 1 0" range="-170 170"/>')
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        parse_mjcf(text, "arm.xml")
    radians = text.replace("<worldbody>", '<compiler angle="radian"/><worldbody>')
    rule = r"limits of joints 'wrist' look like degrees; the file's compiler takes angles as radians \(arm.xml\)"
    with pytest.warns(DegreesWarning, match=rule):
        parse_mjcf(radians, "arm.xml")


def test_without_mujoco_the_message_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(ModelError, match=r'needs the mujoco package, 3.3.1 or later: pip install "cutpoint\[mjcf\]"'):
        parse_mjcf(one_body(""))


def test_what_is_for_urdf_files_is_refused(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(one_body(""))
    with pytest.raises(InputError, match="floating_base and mimic are for URDF files"):
        cutpoint.load(tmp_path / "arm.xml", floating_base=True)
    with pytest.raises(ModelError, match=r"must be a \.urdf, .xacro, .mjcf or .xml"):
        cutpoint.load(tmp_path / "arm.txt")
