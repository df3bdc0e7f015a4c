"""The door of the model: what `build` makes of links and joints, and what it refuses."""

import re
import warnings
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import cutpoint
from cutpoint.errors import ModelError
from cutpoint.model import WORLD, Joint, Limits, Link, Mechanism, Mimic
from cutpoint.model.build import MendedWarning, build
from cutpoint.model.holding import Degrees
from cutpoint.model.limits import DegreesWarning
from cutpoint.model.mechanism import JointKind
from cutpoint.model.pose import is_rigid, pose, roll_pitch_yaw, rotation_about

ANGLES = st.floats(-4.0, 4.0)
LENGTHS = st.floats(-2.0, 2.0)
PLACEMENTS = st.builds(
    lambda angles, offset: pose(roll_pitch_yaw(np.array(angles)), np.array(offset)),
    st.tuples(ANGLES, ANGLES, ANGLES),
    st.tuples(LENGTHS, LENGTHS, LENGTHS),
)
MASSES = st.one_of(st.just(0.0), st.floats(1e-6, 100.0))


def ball(name: str, mass: float = 1.0, com: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Link:
    return Link(name, mass, np.array(com), 0.1 * mass * np.eye(3))


PITCH = 0.3


def chain(*kinds: str, **changes: object) -> Mechanism:
    """Links l0, l1, ... with joints j1, j2, ... of those kinds."""
    links = [ball(f"l{i}", com=(0.1, 0.0, 0.2)) for i in range(len(kinds) + 1)]
    shift = pose(rotation_about(np.array([0.0, 1.0, 0.0]), 0.3), np.array([0.0, 0.0, 1.0]))
    joints = [
        Joint(f"j{i}", kind, f"l{i - 1}", f"l{i}", shift, pitch=PITCH if kind == "helical" else 0.0)  # pyright: ignore
        for i, kind in enumerate(kinds, 1)
    ]
    return build("chain", links, joints, **changes)  # pyright: ignore[reportArgumentType]


def followers(*steps: tuple[str, Mimic | None], **options: object) -> Mechanism:
    """Joints on one base, each with its mimic."""
    joints = [Joint(name, "revolute", "base", f"on_{name}", mimic=mimic) for name, mimic in steps]
    links = [ball("base"), *(ball(joint.child) for joint in joints)]
    return build("hand", links, joints, **options)  # pyright: ignore[reportArgumentType]


def spatial_inertia(link: Link, placement: np.ndarray) -> np.ndarray:
    """(6, 6) about the parent frame's origin: the sum over pieces is the inertia of the whole."""
    rotation = placement[:3, :3]
    x, y, z = rotation @ link.com + placement[:3, 3]
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    about_origin = rotation @ link.inertia @ rotation.T + link.mass * cross @ cross.T
    return np.block([[link.mass * np.eye(3), link.mass * cross.T], [link.mass * cross, about_origin]])


@given(st.lists(st.tuples(MASSES, st.tuples(LENGTHS, LENGTHS, LENGTHS), PLACEMENTS), max_size=4))
def test_lumping_adds_spatial_inertias(pieces) -> None:
    carried = [ball(f"piece{i}", mass, com) for i, (mass, com, _) in enumerate(pieces)]
    fixed = [Joint(f"f{i}", "fixed", "arm", f"piece{i}", at) for i, (_, _, at) in enumerate(pieces)]
    whole = build("lump", [ball("base"), ball("arm"), *carried], [Joint("j", "revolute", "base", "arm"), *fixed])
    expected = spatial_inertia(ball("arm"), np.eye(4))
    for link, joint in zip(carried, fixed, strict=True):
        expected = expected + spatial_inertia(link, joint.placement)
    (body,) = whole.bodies
    found = spatial_inertia(Link("arm", body.mass, body.com, body.inertia), np.eye(4))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13 * np.max(np.abs(expected)))


@given(ANGLES, st.sampled_from(["revolute", "continuous", "prismatic", "helical"]))
def test_a_locked_joint_is_a_fixed_one_at_that_coordinate(value: float, kind: str) -> None:
    locked = chain("revolute", kind, "fixed", lock={"j2": value})
    axis = np.array([0.0, 0.0, 1.0])
    turn = np.eye(3) if kind == "prismatic" else rotation_about(axis, value)
    motion = pose(turn, {"prismatic": value, "helical": PITCH * value}.get(kind, 0.0) * axis)
    step = chain("revolute").bodies[0].placement
    np.testing.assert_allclose(locked.frames["l2"].placement, step @ motion, rtol=0, atol=1e-15)
    np.testing.assert_allclose(locked.frames["l3"].placement, step @ motion @ step, rtol=0, atol=1e-14)
    assert [body.name for body in locked.bodies] == ["l1"]
    assert locked.bodies[0].mass == 3.0


def test_what_is_fixed_to_the_world_is_a_frame_without_mass() -> None:
    robot = chain("fixed", "revolute")
    assert [body.name for body in robot.bodies] == ["l2"]
    assert robot.bodies[0].mass == 1.0
    assert {name for name, frame in robot.frames.items() if frame.body == WORLD} == {"l0", "l1", "j1"}


def test_a_floating_base_carries_the_root_link() -> None:
    robot = chain("fixed", "revolute", floating_base=True)
    base, arm = robot.bodies
    assert (base.name, base.joint.name, base.joint.kind, base.parent, base.mass) == (
        "l0",
        "root_joint",
        "floating",
        WORLD,
        2.0,
    )
    assert arm.parent == 0


def test_a_robot_that_floats_already_does_not_float_twice() -> None:
    joint = Joint("free", "floating", "world", "trunk")
    assert len(build("r", [ball("world"), ball("trunk")], [joint], floating_base=True).bodies) == 2
    told = r"joint 'free': already lets the robot float, from link 'world', which has no mass; leave out floating_base"
    with pytest.raises(ModelError, match=told):
        build("r", [Link("world"), ball("trunk")], [joint], floating_base=True)


def test_what_floats_may_hang_on_what_moves() -> None:
    robot = chain("spherical", "floating", "planar")
    assert [(body.joint.kind, body.parent) for body in robot.bodies] == [
        ("spherical", WORLD),
        ("floating", 0),
        ("planar", 1),
    ]


def test_a_universal_joint_is_two_revolute_ones_through_one_point() -> None:
    limits, at = Limits(-1.0, 1.0), pose(roll_pitch_yaw(np.array([0.1, 0.2, 0.3])), np.ones(3))
    axes = {"axis": np.array([2.0, 0.0, 0.0]), "second_axis": np.array([0.0, 3.0, 4.0])}
    joint = Joint("u", "universal", "base", "arm", at, limits=limits, damping=0.5, **axes)
    first, second = build("r", [ball("base"), ball("arm")], [joint]).bodies
    assert (first.joint.name, first.name, first.mass) == ("u_1", "u_cross", 0.0)
    assert (second.joint.name, second.name, second.mass) == ("u_2", "arm", 1.0)
    assert {first.joint.kind, second.joint.kind} == {"revolute"}
    assert first.joint.limits == second.joint.limits == limits
    assert first.joint.damping == second.joint.damping == 0.5
    np.testing.assert_array_equal(first.placement, at)
    np.testing.assert_array_equal(second.placement, np.eye(4))
    np.testing.assert_array_equal(first.joint.axis, [1.0, 0.0, 0.0])
    np.testing.assert_array_equal(second.joint.axis, [0.0, 0.6, 0.8])


@pytest.mark.parametrize("kind", ["spherical", "floating"])
def test_a_joint_without_axis_may_state_any(kind: str) -> None:
    joint = Joint("j", kind, "base", "arm", axis=np.zeros(3))  # pyright: ignore[reportArgumentType]
    assert build("r", [ball("base"), ball("arm")], [joint]).bodies[0].joint.kind == kind


def test_a_joint_is_a_frame_where_no_link_has_its_name() -> None:
    joints = [Joint("arm", "revolute", "base", "arm"), Joint("tip", "fixed", "arm", "hand")]
    frames = build("r", [ball("base"), ball("arm"), ball("hand")], joints).frames
    assert set(frames) == {"base", "arm", "hand", "tip"}


def test_a_massless_link_may_carry_mass() -> None:
    joints = [Joint("pan", "revolute", "base", "cross"), Joint("tilt", "revolute", "cross", "head")]
    robot = build("r", [ball("base"), Link("cross"), ball("head")], joints)
    assert [body.mass for body in robot.bodies] == [0.0, 1.0]


def test_what_is_built_cannot_be_written_to() -> None:
    body = chain("revolute").bodies[0]
    for array in (body.com, body.inertia, body.placement, body.joint.axis):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0


def test_a_chain_of_mimics_points_at_its_leader() -> None:
    robot = followers(("a", None), ("b", Mimic("a", 2.0, 1.0)), ("c", Mimic("b", 3.0, -1.0)), coupled=True)
    assert [body.joint.mimic for body in robot.bodies] == [None, Mimic("a", 2.0, 1.0), Mimic("a", 6.0, 2.0)]


def test_a_coupled_follower_of_a_locked_leader_is_locked_too() -> None:
    robot = followers(("a", None), ("b", Mimic("a", 2.0, 0.1)), ("c", None), coupled=True, lock={"a": 0.3})
    assert [body.joint.name for body in robot.bodies] == ["c"]
    expected = rotation_about(np.array([0.0, 0.0, 1.0]), 0.7)
    np.testing.assert_allclose(robot.frames["on_b"].placement[:3, :3], expected, rtol=0, atol=1e-15)


def test_an_independent_follower_of_a_locked_leader_is_free() -> None:
    robot = followers(("a", None), ("b", Mimic("a")), lock={"a": 0.3})
    assert [(body.joint.name, body.joint.mimic) for body in robot.bodies] == [("b", None)]


MIMICS = {
    "circle": ([("a", Mimic("b")), ("b", Mimic("a"))], "joint 'a': mimics in a circle, through joint 'a'"),
    "nowhere": ([("a", Mimic("x"))], "joint 'a': mimics joint 'x', which does not exist; there are: 'a'"),
    "infinite": (
        [("a", None), ("b", Mimic("a", np.inf))],
        "joint 'b': mimic multiplier inf and offset 0.0 must be finite",
    ),
    "huge": (
        [("a", None), ("b", Mimic("a", 1e200))],
        "joint 'b': mimic multiplier and offset must not exceed 1e+12 in SI units, beyond any machine, got 1e+200; "
        "check its unit",
    ),
    "huge as a chain": (
        [("a", None), ("b", Mimic("a", 1.0, 1e10)), ("c", Mimic("b", 1e9))],
        "joint 'c': mimic multiplier and offset must not exceed 1e+12 in SI units, beyond any machine, got 1e+19; "
        "check its unit",
    ),
    "long": (
        [("0", None), *((str(i), Mimic(str(i - 1))) for i in range(1, 19))],
        "joint '17': mimics through more than 16 joints; name the leader itself",
    ),
}


def test_a_leader_has_one_coordinate() -> None:
    joints = [Joint("ball", "spherical", "base", "a"), Joint("j", "revolute", "a", "b", mimic=Mimic("ball"))]
    with pytest.raises(
        ModelError, match="joint 'j': mimics joint 'ball', which is spherical; a leader must be one of revol"
    ):
        build("r", [ball("base"), ball("a"), ball("b")], joints, coupled=True)


@pytest.mark.parametrize("case", MIMICS)
def test_a_mimic_that_leads_nowhere_is_refused(case: str) -> None:
    steps, message = MIMICS[case]
    with pytest.raises(ModelError) as caught:
        followers(*steps, coupled=True)
    assert str(caught.value) == message


LOCKS = {
    "unknown": ({"x": 0.0}, "lock of joint 'x': no joint has this name; there are: 'j1', 'j2'"),
    "fixed": (
        {"j2": 0.0},
        "lock of joint 'j2': the joint is fixed; it must be one of revolute, continuous, prismatic, helical",
    ),
    "nan": ({"j1": np.nan}, "lock of joint 'j1': value nan must be a finite number"),
    "huge": (
        {"j1": -1e160},
        "lock of joint 'j1': value must not exceed 1e+12 in SI units, beyond any machine, got 1e+160; check its unit",
    ),
}


@pytest.mark.parametrize("case", LOCKS)
def test_a_lock_that_cannot_be_is_refused(case: str) -> None:
    lock, message = LOCKS[case]
    with pytest.raises(ModelError) as caught:
        chain("revolute", "fixed", lock=lock)
    assert str(caught.value) == message


def test_a_follower_that_slides_far_with_its_locked_leader_is_refused() -> None:
    links = [ball("base"), ball("a"), ball("b")]
    joints = [Joint("j", "prismatic", "base", "a"), Joint("k", "prismatic", "a", "b", mimic=Mimic("j", 1e8))]
    with pytest.raises(ModelError, match=r"joint 'k': placement where it is locked must not exceed 1e\+12 .* 1e\+18"):
        build("r", links, joints, coupled=True, lock={"j": 1e10})


def test_gravity_is_of_a_size_that_worlds_have() -> None:
    with pytest.raises(ModelError, match=r"gravity: vector must not exceed 1e\+12 in SI units"):
        build("r", [ball("base")], [], gravity=(0.0, 0.0, 1e20))
    with pytest.raises(ModelError, match=r"gravity: must be a vector \(3,\) .*, such as .*, got one number, 9\.81"):
        build("r", [ball("base")], [], gravity=9.81)


def test_a_lock_in_degrees_is_pointed_out() -> None:
    joint = Joint("j", "revolute", "base", "arm", limits=Limits(-3.0, 3.0))
    with pytest.raises(ModelError, match=r"value 90.0 rad is far outside its limits; 90 degrees are 1.5708 rad"):
        build("r", [ball("base"), ball("arm")], [joint], lock={"j": 90.0})


@pytest.mark.parametrize("kind", ["revolute", "continuous"])
@pytest.mark.parametrize("place", [30.0, -30, np.float64(7.0)])
def test_a_lock_beyond_a_turn_without_limits_is_warned_of_unless_in_degrees(kind: JointKind, place: float) -> None:
    joint, links = Joint("j", kind, "base", "arm"), [ball("base"), ball("arm")]
    told = f"lock of joint 'j': position {place:g} rad is beyond a turn: {place:g} degrees are {np.radians(place):.6g}"
    with pytest.warns(DegreesWarning, match=told):
        build("r", links, [joint], lock={"j": place})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        build("r", links, [joint], lock={"j": Degrees(100 * place)})
        build("r", links, [replace(joint, kind="revolute", limits=Limits(-40.0, 40.0))], lock={"j": place})
        build("r", links, [joint], lock={"j": 2 * np.pi})


def test_a_follower_is_not_locked_apart_from_its_leader() -> None:
    with pytest.raises(ModelError, match="lock of joint 'b': the joint follows joint 'a'; lock that one, or load"):
        followers(("a", None), ("b", Mimic("a")), coupled=True, lock={"b": 0.0})


SKEWED = np.array([[1.0, 0.2, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])

LINKS = {
    "skewed tensor": (
        Link("arm", 1.0, inertia=SKEWED),
        "inertia must be symmetric; mirrored entries differ by 0.2 kg m2",
    ),
    "infinite mass": (Link("arm", np.inf), "mass must be finite, got inf"),
    "com of wrong shape": (
        Link("arm", 1.0, com=np.zeros(2)),
        "com must have shape (3,) and hold real numbers, got shape (2,) of float64",
    ),
    "mass of a mountain range": (
        Link("arm", 1e300),
        "mass must not exceed 1e+12 in SI units, beyond any machine, got 1e+300; check its unit",
    ),
    "com beyond the moon": (
        Link("arm", 1.0, np.array([0.0, -1e200, 0.0])),
        "com must not exceed 1e+12 in SI units, beyond any machine, got 1e+200; check its unit",
    ),
    "inertia without mass": (
        Link("arm", 0.0, inertia=np.diag([0.1, 0.2, 0.2])),
        "principal moments of inertia 0.1, 0.2, 0.2 kg m2: without mass (0 kg) there is no inertia;"
        " state the mass or leave out <inertial>",
    ),
}


def test_all_bodies_that_no_mass_can_make_are_named_with_what_would_mend_them() -> None:
    def links(more: float) -> list[Link]:
        tensor = np.diag([0.1, 0.2, 0.31]) + more * np.eye(3)
        return [ball("base"), *(Link(name, 1.0, inertia=tensor) for name in ("upper", "fore", "hand"))]

    joints = [Joint(f"to_{child}", "revolute", parent, child) for parent, child in zip(("base", "upper", "fore"),
              ("upper", "fore", "hand"), strict=True)]  # fmt: skip
    rule = "the largest exceeds the sum of the others by 3.23% of itself (triangle inequality)"
    with pytest.raises(ModelError, match=re.escape(f"kg m2: {rule}; check")) as caught:
        build("r", links(0.0), joints)
    told = re.search(
        r"increasing ixx, iyy and izz by (\S+) would do, of 'fore' by \1, of 'hand' by \1; mend_inertia=True does that",
        str(caught.value),
    )
    assert told is not None
    assert caught.value.evidence["links"] == ["upper", "fore", "hand"]
    build("r", links(float(told[1])), joints)
    with pytest.warns(MendedWarning, match=rf"are increased, .* 'upper' by {told[1]}, 'fore' by .*, 'hand' by"):
        mended = build("r", links(0.0), joints, mend_inertia=True)
    for body in mended.bodies:
        np.testing.assert_allclose(body.inertia, links(float(told[1]))[1].inertia, rtol=1e-3)
    with pytest.raises(ModelError, match=r"without mass \(0 kg\) there is no inertia; state the mass"):
        build("r", [ball("base"), LINKS["inertia without mass"][0]], [Joint("j", "revolute", "base", "arm")],
              mend_inertia=True)  # fmt: skip


@pytest.mark.parametrize("case", LINKS)
def test_a_wrong_link_is_refused(case: str) -> None:
    link, message = LINKS[case]
    with pytest.raises(ModelError) as caught:
        build("r", [ball("base"), link], [Joint("j", "revolute", "base", "arm")], place="arm.urdf")
    assert str(caught.value) == f"link 'arm': {message} (arm.urdf)"


JOINTS = {
    "mirrored placement": (
        {"placement": np.diag([1.0, 1.0, -1.0, 1.0])},
        "placement must be a proper rotation and a translation (R R^T = 1, det R = 1, last row 0 0 0 1)",
    ),
    "scaled placement": (
        {"placement": np.diag([2.0, 2.0, 2.0, 1.0])},
        "placement must be a proper rotation and a translation (R R^T = 1, det R = 1, last row 0 0 0 1)",
    ),
    "placement beyond the moon": (
        {"placement": pose(np.eye(3), np.array([0.0, 0.0, 1e308]))},
        "placement must not exceed 1e+12 in SI units, beyond any machine, got 1e+308; check its unit",
    ),
    "unknown kind": (
        {"kind": "screw"},
        "kind 'screw' is not supported; there are: 'fixed', 'revolute', 'continuous', 'prismatic', 'helical',"
        " 'universal', 'planar', 'spherical', 'floating'",
    ),
    "no normal": (
        {"kind": "planar", "axis": np.zeros(3)},
        "axis [0. 0. 0.] has no length; give it a direction",
    ),
    "no pitch": ({"kind": "helical"}, "pitch 0.0 m/rad must not be zero; without one the joint is revolute"),
    "infinite pitch": ({"kind": "helical", "pitch": np.inf}, "pitch must be finite, got inf"),
    "no second axis": ({"kind": "universal"}, "needs a second_axis, a direction (3,)"),
    "axes along one line": (
        {"kind": "universal", "second_axis": np.array([0.0, 0.0, -2.0])},
        "second_axis [ 0.  0. -2.] must not be parallel to axis [0. 0. 1.]",
    ),
    "follower with three coordinates": (
        {"kind": "spherical", "mimic": Mimic("j")},
        "mimics joint 'j', but is spherical; a follower must be one of revolute, continuous, prismatic, helical",
    ),
    "nan limit": ({"limits": Limits(lower=np.nan)}, "limit lower must be a number, got nan"),
}


@pytest.mark.parametrize("case", JOINTS)
def test_a_wrong_joint_is_refused(case: str) -> None:
    changes, message = JOINTS[case]
    joint = Joint(**({"name": "j", "kind": "revolute", "parent": "base", "child": "arm"} | changes))
    with pytest.raises(ModelError) as caught:
        build("r", [ball("base"), ball("arm")], [joint], place="arm.urdf")
    assert str(caught.value) == f"joint 'j': {message} (arm.urdf)"


@pytest.mark.parametrize("length", [1e-5, 1.0, 1e150, 1e200, 8e307])
@pytest.mark.parametrize("kind", ["revolute", "universal"])
def test_an_axis_of_any_length_has_its_direction(kind: str, length: float) -> None:
    axis, second = length * np.array([1.0, -2.0, 2.0]), length * np.array([2.0, 2.0, 1.0])
    joint = Joint("j", kind, "base", "arm", axis=axis, second_axis=second)  # pyright: ignore[reportArgumentType]
    bodies = build("r", [ball("base"), ball("arm")], [joint]).bodies
    found = np.array([body.joint.axis for body in bodies])
    np.testing.assert_allclose(found, np.array([[1.0, -2.0, 2.0], [2.0, 2.0, 1.0]])[: len(bodies)] / 3, rtol=1e-15)


def test_inertia_without_mass_counts_on_a_body_that_has_some() -> None:
    links = [ball("base"), ball("arm"), Link("disc", inertia=np.eye(3)), Link("frame")]
    joints = [Joint("j", "revolute", "base", "arm")]
    joints += [Joint(f"on_{name}", "fixed", "arm", name) for name in ("disc", "frame")]
    body = build("r", links, joints).bodies[0]
    np.testing.assert_allclose(body.inertia, 1.1 * np.eye(3), rtol=1e-15)


@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0), st.floats(0.0, 1.0), PLACEMENTS)
def test_any_tensor_that_mass_can_have_passes(a: float, b: float, c: float, placement: np.ndarray) -> None:
    """Second moments a, b, c >= 0 along axes make the tensor diag(b + c, a + c, a + b): the triangle inequality."""
    rotation = placement[:3, :3]
    inertia = rotation @ np.diag([b + c, a + c, a + b]) @ rotation.T
    links = [ball("base"), Link("arm", 1.0, inertia=inertia)]
    assert build("r", links, [Joint("j", "revolute", "base", "arm")]).bodies[0].mass == 1.0


def test_a_wrong_name_among_many_brings_the_nearest_to_mind() -> None:
    with pytest.raises(ModelError, match=r"no joint has this name; did you mean 'j7'\?$"):
        chain(*["revolute"] * 30, lock={"J7": 0.0})
    with pytest.raises(ModelError, match=r"no joint has this name; there are: 'j1', .*, \.\.\. \(30 in all\), 'j30'$"):
        chain(*["revolute"] * 30, lock={"elbow": 0.0})


@pytest.mark.parametrize("count", [5, 30])
def test_a_joint_of_another_number_is_not_offered_for_one_that_is_missing(count: int) -> None:
    with pytest.raises(ModelError, match=rf"there are: 'j1', .*'j{count}'$"):
        chain(*["revolute"] * count, lock={f"j{count + 1}": 0.0})


def test_a_call_with_a_wrong_name_says_no_more_than_one_can_read() -> None:
    robot = cutpoint.Robot(chain(*["revolute"] * 300))
    with pytest.raises(cutpoint.InputError, match=r"no frame is named 'J7'; did you mean 'j7'\?") as caught:
        robot.frame_pose(np.zeros(300), "J7")
    assert len(str(caught.value)) < 100
    assert {*robot.frames} == {*caught.value.evidence["known"]}


def test_a_taken_name_cannot_be_that_of_the_floating_joint() -> None:
    with pytest.raises(ModelError, match="joint 'root_joint': this name is taken by the joint that floating_base adds"):
        build("r", [ball("a"), ball("b")], [Joint("root_joint", "revolute", "a", "b")], floating_base=True)


@given(PLACEMENTS)
def test_placements_of_angles_are_rigid(placement: np.ndarray) -> None:
    assert is_rigid(placement)
