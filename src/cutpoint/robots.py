"""Robots that come with the package.

The six-joint arm of Xia et al. (2019), IEEE Access 7, doi 10.1109/ACCESS.2019.2919749: lengths and Table 1 of section
IV.A, joint orientations of eqs. (34)-(36).  `robots_data/` has its drive file, and the same arm as a URDF.
"""

from pathlib import Path

import numpy as np

from cutpoint.model.build import build
from cutpoint.model.mechanism import Joint, Link, Mechanism
from cutpoint.model.pose import pose
from cutpoint.robot import Robot

_DATA = Path(__file__).parent / "robots_data"

XIA2019_URDF = _DATA / "xia2019.urdf"
XIA2019_DRIVES = _DATA / "xia2019.drives.yaml"

# Table 1: kg; kg m2, taken as isotropic about the centroid; height of the centroid on the link's z axis, m
_MASSES = (3.2, 3.2, 2.0, 2.0, 1.2, 1.2)
_MOMENTS = (0.0056, 0.0044, 0.0035, 0.0031, 0.0026, 0.0021)
_CENTROIDS = (0.15, 0.0, 0.0, 0.1515, 0.0, 0.25)
_CENTROID_6_AS_PRINTED = -0.25

# origin of each joint on the link before, m: l1 up to the shoulder, l2 to the elbow, l3 along the forearm to the wrist
_ORIGINS = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.3), (0.3, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.303), (0.0, 0.0, 0.0))
_TOOL = (0.0, 0.0, 0.5)

# (34)-(36) at q = 0
_STRAIGHT = np.eye(3)
_QUARTER_ABOUT_X = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
_ALONG_FOREARM = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
_ORIENTATIONS = (_STRAIGHT, _QUARTER_ABOUT_X, _STRAIGHT, _ALONG_FOREARM, _QUARTER_ABOUT_X, _QUARTER_ABOUT_X.T)


def xia2019() -> Robot:
    """The paper's arm with the drives of its drive file."""
    from cutpoint.formats import load_drives  # slow to import

    mechanism = xia2019_mechanism()
    return Robot(mechanism, load_drives(XIA2019_DRIVES, mechanism))


def xia2019_mechanism(as_printed: bool = False) -> Mechanism:
    """The paper's arm: joints "joint1" ... "joint6", links "link1" ... "link6" on "base", and the frame "tool".

    as_printed: take the centroid of link 6 at z = -0.25 m, as Table 1 prints it.  By default it is at +0.25 m: there
    the hand continues the forearm, and only there do the torques have the ratios of Table 3.
    """
    heights = (*_CENTROIDS[:5], _CENTROID_6_AS_PRINTED) if as_printed else _CENTROIDS
    links = [_link(i, height) for i, height in enumerate(heights, start=1)]
    joints = [_joint(i) for i in range(1, 7)]
    tool = Joint("tool_joint", "fixed", "link6", "tool", placement=pose(_STRAIGHT, np.array(_TOOL)))
    return build("xia2019", [Link("base"), *links, Link("tool")], [*joints, tool])


def _link(i: int, height: float) -> Link:
    moments = _MOMENTS[i - 1] * np.eye(3)
    return Link(f"link{i}", _MASSES[i - 1], com=np.array([0.0, 0.0, height]), inertia=moments)


def _joint(i: int) -> Joint:
    """Without limits: the paper states none."""
    parent = f"link{i - 1}" if i > 1 else "base"
    placement = pose(_ORIENTATIONS[i - 1], np.array(_ORIGINS[i - 1]))
    return Joint(f"joint{i}", "continuous", parent, f"link{i}", placement=placement)
