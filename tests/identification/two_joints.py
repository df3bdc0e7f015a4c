"""An arm of two joints in a vertical plane, which a reader can work out by hand."""

from pathlib import Path
from tempfile import TemporaryDirectory

import cutpoint
from cutpoint import Robot

LENGTH = 0.5
"""m, between the two axes, both along y."""

LIMITS = '<limit lower="-2" upper="2.5" velocity="3" effort="60"/>'


def urdf_text(limits: str = LIMITS) -> str:
    def link(name: str, mass: float) -> str:
        inertia = f'<inertia ixx="0.01" ixy="0" ixz="0" iyy="{mass * 0.02}" iyz="0" izz="{mass * 0.02}"/>'
        placed = f'<origin xyz="0.2 0.01 0.03"/><mass value="{mass}"/>'
        return f'<link name="{name}"><inertial>{placed}{inertia}</inertial></link>'

    def joint(name: str, parent: str, child: str, x: float) -> str:
        return (
            f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="{x} 0 0"/><axis xyz="0 1 0"/>{limits}</joint>'
        )

    joints = joint("shoulder", "base", "upper", 0.0) + joint("elbow", "upper", "lower", LENGTH)
    return f'<robot name="two"><link name="base"/>{link("upper", 4.0)}{link("lower", 2.5)}{joints}</robot>'


def two_joints(limits: str = LIMITS) -> Robot:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "two.urdf"
        path.write_text(urdf_text(limits))
        return cutpoint.load(path)
