"""The paper's arm, as code and as files, is the arm of the paper."""

import numpy as np
import pytest
import yaml

from cutpoint.formats.urdf.urdf import load_urdf
from cutpoint.robots import XIA2019_DRIVES, XIA2019_URDF, xia2019_mechanism
from cutpoint.studies.paper import newton_euler
from cutpoint.studies.paper.chain import chain_of
from paper import arm, data

JOINTS = [f"joint{i}" for i in range(1, 7)]
STATES = np.concatenate([np.zeros((1, 3, 6)), np.random.default_rng(3).uniform(-3, 3, (5, 3, 6))])

# Harmonic Drive LLC, CHA manual 1018854, ratios above 50: T1, T2 in N m, K1, K2 in N m/rad, by size
CATALOGUE = {20: (7, 25, 16e3, 25e3), 17: (3.9, 12, 10e3, 14e3), 14: (2, 6.9, 4.7e3, 6.1e3)}
SIZES = dict(zip(JOINTS, (20, 20, 17, 17, 14, 14), strict=True))


@pytest.fixture(scope="module")
def drives():
    return yaml.safe_load(XIA2019_DRIVES.read_text())


@pytest.mark.parametrize("as_printed", [False, True])
def test_the_arm_has_the_torques_of_the_transcribed_equations(as_printed):
    chain = chain_of(xia2019_mechanism(as_printed))
    centroids = data.CENTROIDS_AS_PRINTED if as_printed else data.CENTROIDS
    for q, v, a in STATES:
        expected = arm.joint_torques(q, v, a, centroids=centroids)
        np.testing.assert_allclose(newton_euler.torques(chain, q, v, a), expected, rtol=1e-12, atol=1e-11)


def test_only_the_centroid_of_link_6_differs_as_printed():
    ours, printed = (chain_of(xia2019_mechanism(as_printed)) for as_printed in (False, True))
    assert np.array_equal(printed.coms[5], [0, 0, -0.25])
    assert np.array_equal(np.abs(ours.coms), np.abs(printed.coms))


def test_bodies_joints_and_tool_have_their_names_and_places():
    mechanism = xia2019_mechanism()
    assert [body.name for body in mechanism.bodies] == [f"link{i}" for i in range(1, 7)]
    assert [body.joint.name for body in mechanism.bodies] == JOINTS
    tool = mechanism.frames["tool"]
    assert tool.body == 5
    assert np.array_equal(tool.placement[:3, 3], data.TOOL)


def test_the_urdf_is_the_same_arm():
    ours, theirs = xia2019_mechanism(), load_urdf(XIA2019_URDF)
    assert ours.name == theirs.name
    for mine, other in zip(ours.bodies, theirs.bodies, strict=True):
        assert (mine.name, mine.parent, mine.joint.name) == (other.name, other.parent, other.joint.name)
        assert (mine.joint.kind, mine.joint.limits) == (other.joint.kind, other.joint.limits)
        assert np.array_equal(mine.joint.axis, other.joint.axis)
        np.testing.assert_allclose(mine.placement, other.placement, atol=1e-15)
        assert mine.mass == other.mass
        np.testing.assert_allclose(mine.com, other.com, atol=1e-15)
        np.testing.assert_allclose(mine.inertia, other.inertia, atol=1e-15)
    assert ours.frames.keys() == theirs.frames.keys()
    for name, frame in ours.frames.items():
        np.testing.assert_allclose(frame.placement, theirs.frames[name].placement, atol=1e-15)


def test_the_drive_file_has_a_drive_for_every_joint(drives):
    assert list(drives["drives"]) == JOINTS
    assert drives["version"] == 1


def test_the_rotor_has_the_inertia_that_the_paper_multiplies_by_the_ratio(drives):
    defaults = drives["defaults"]
    assert defaults["ratio"] == data.ELL
    assert defaults["ratio"] * defaults["rotor"]["inertia"] == pytest.approx(data.I_M, rel=1e-12)


def test_link_friction_is_table_2_and_motor_friction_is_off(drives):
    printed = {"coulomb": data.F_C, "static": data.F_S, "viscous": data.F_V, "stribeck_velocity": data.V_S}
    for i, joint in enumerate(JOINTS):
        friction = drives["drives"][joint]["friction"]
        assert friction.keys() == {"link"}
        assert {key: friction["link"][key] for key in printed} == {key: value[i] for key, value in printed.items()}


@pytest.mark.parametrize("joint", JOINTS)
def test_compliance_follows_the_catalogue_up_to_its_second_torque(drives, joint):
    T1, T2, K1, K2 = CATALOGUE[SIZES[joint]]
    law = drives["drives"][joint]["compliance"]["flexspline"]
    torque = np.linspace(0, T2, 200)
    catalogue = np.interp(torque, [0, T1, T2], [0, T1 / K1, T1 / K1 + (T2 - T1) / K2])
    ours = np.arctan(law["hardening"] * torque) / (law["hardening"] * law["stiffness"])
    arc_minute = np.deg2rad(1 / 60)
    assert law["stiffness"] == K1
    assert abs(ours[-1] - catalogue[-1]) < 0.005 * arc_minute
    assert np.abs(ours - catalogue).max() < 0.22 * arc_minute
