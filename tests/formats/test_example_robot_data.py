"""The robots of the package example-robot-data, as they are found in the field, against Pinocchio's reading of them."""

import warnings
from importlib.metadata import files
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from cutpoint.errors import ModelError
from cutpoint.formats import MimicWarning, load_urdf
from cutpoint.model import WORLD, Mechanism

PACKAGED = [entry for entry in files("example-robot-data") or () if entry.suffix == ".urdf"]

URDFS = {f"{e.parts[-3].removesuffix('_description')}/{e.name}": Path(str(e.locate())) for e in PACKAGED}
"""By the robot's folder and the file's name: `ur/ur10_robot.urdf`."""

NOT_LOADED = {
    "romeo/romeo.urdf": "link 'LFinger11Link': moves with joint 'LHand' but has no mass and carries none",
    "romeo/romeo_laas_small.urdf": "link 'LShoulderYaw_link': principal moments of inertia .* \\(triangle inequality",
    "romeo/romeo_small.urdf": "link 'RShoulderYawLink': principal moments of inertia .* \\(triangle inequality",
    "ur/ur3.urdf": "the robot has no links",
}
"""Which files are wrong, and how: fingers without inertials, tensors no mass can have, an empty robot."""

LOADED = sorted(URDFS.keys() - NOT_LOADED.keys())

EXACT = 1e-12


def load(name: str, floating_base: bool = False) -> Mechanism:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MimicWarning)
        return load_urdf(URDFS[name], floating_base=floating_base)


def pinocchio(name: str, floating_base: bool) -> pin.Model:
    path = str(URDFS[name])
    return pin.buildModelFromUrdf(path, pin.JointModelFreeFlyer()) if floating_base else pin.buildModelFromUrdf(path)


def test_the_package_has_the_files_that_are_counted_here() -> None:
    assert len(URDFS) == 69
    assert len(LOADED) >= 65


@pytest.mark.parametrize("name", NOT_LOADED)
def test_a_file_that_is_wrong_is_refused_with_its_cause(name: str) -> None:
    with pytest.raises(ModelError, match=NOT_LOADED[name]):
        load(name)


@pytest.mark.parametrize("floating_base", [False, True])
@pytest.mark.parametrize("name", LOADED)
def test_bodies_joints_and_frames_are_those_of_pinocchio(name: str, floating_base: bool) -> None:
    ours, theirs = load(name, floating_base), pinocchio(name, floating_base)
    carriers = ["universe", *(body.joint.name for body in ours.bodies)]
    assert set(carriers) == set(theirs.names)
    for body in ours.bodies:
        index = theirs.getJointId(body.joint.name)
        inertia = theirs.inertias[index]
        assert theirs.names[theirs.parents[index]] == carriers[body.parent + 1]
        np.testing.assert_allclose(body.placement, theirs.jointPlacements[index].homogeneous, rtol=0, atol=EXACT)
        np.testing.assert_allclose(body.mass, inertia.mass, rtol=EXACT)
        np.testing.assert_allclose(body.mass * body.com, inertia.mass * inertia.lever, rtol=0, atol=EXACT)
        np.testing.assert_allclose(body.inertia, inertia.inertia, rtol=0, atol=EXACT * max(1.0, body.mass))
    for frame in theirs.frames:
        if frame.type == pin.FrameType.BODY:
            placed = ours.frames[frame.name]
            assert theirs.names[frame.parentJoint] == carriers[placed.body - WORLD]
            np.testing.assert_allclose(placed.placement, frame.placement.homogeneous, rtol=0, atol=EXACT)


@pytest.mark.parametrize(
    "name", ["panda/panda.urdf", "tiago/tiago.urdf", "ur/ur10_robot.urdf", "talos_data/talos_reduced.urdf"]
)
def test_every_link_and_joint_of_a_file_is_a_frame(name: str) -> None:
    ours, theirs = load(name), pinocchio(name, False)
    assert {frame.name for frame in theirs.frames} - {"universe"} <= set(ours.frames)


@pytest.mark.parametrize(
    "name", ["panda/panda.urdf", "talos_data/talos_full_v2.urdf", "baxter/baxter.urdf", "pr2/pr2.urdf"]
)
def test_limits_dynamics_and_axes_are_those_of_pinocchio(name: str) -> None:
    ours, theirs = load(name), pinocchio(name, False)
    data = theirs.createData()
    for body in ours.bodies:
        joint, index = body.joint, theirs.getJointId(body.joint.name)
        column = theirs.idx_vs[index]
        assert joint.damping == theirs.damping[column]
        assert joint.friction == theirs.upperDryFrictionLimit[column]
        assert joint.limits.effort == theirs.upperEffortLimit[column]
        assert joint.limits.velocity == theirs.upperVelocityLimit[column]
        if joint.kind in ("revolute", "prismatic"):
            row = theirs.idx_qs[index]
            bounds = (theirs.lowerPositionLimit[row], theirs.upperPositionLimit[row])
            assert (joint.limits.lower, joint.limits.upper) == bounds
        subspace = np.zeros(6)
        subspace[slice(0, 3) if joint.kind == "prismatic" else slice(3, 6)] = joint.axis
        np.testing.assert_allclose(subspace, _motion_subspace(theirs, data, index), rtol=0, atol=EXACT)


def _motion_subspace(model: pin.Model, data: pin.Data, index: int) -> np.ndarray:
    """Of one joint in its own frame, linear part first."""
    q = pin.neutral(model)
    jacobian = pin.computeJointJacobian(model, data, q, index)
    return jacobian[:, model.idx_vs[index]]


def test_locked_joints_are_lumped_as_pinocchio_does() -> None:
    lock = {"panda_joint4": -0.7, "panda_finger_joint1": 0.03, "panda_finger_joint2": 0.01}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MimicWarning)
        ours = load_urdf(URDFS["panda/panda.urdf"], lock=lock)
    whole = pinocchio("panda/panda.urdf", False)
    q = pin.neutral(whole)
    for name, value in lock.items():
        q[whole.idx_qs[whole.getJointId(name)]] = value
    theirs = pin.buildReducedModel(whole, [whole.getJointId(name) for name in lock], q)
    assert {body.joint.name for body in ours.bodies} == set(theirs.names) - {"universe"}
    for body in ours.bodies:
        index = theirs.getJointId(body.joint.name)
        np.testing.assert_allclose(body.placement, theirs.jointPlacements[index].homogeneous, rtol=0, atol=EXACT)
        np.testing.assert_allclose(body.mass, theirs.inertias[index].mass, rtol=EXACT)
        np.testing.assert_allclose(body.com, theirs.inertias[index].lever, rtol=0, atol=EXACT)
        np.testing.assert_allclose(body.inertia, theirs.inertias[index].inertia, rtol=0, atol=EXACT)
