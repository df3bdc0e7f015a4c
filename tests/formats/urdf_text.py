"""URDF documents for tests, one element a line."""


def link(name: str, mass: object = 1.0, moments: tuple[float, float, float] = (0.1, 0.1, 0.1), origin: str = "") -> str:
    """A link; without mass it has no <inertial>."""
    if mass is None:
        return f'<link name="{name}"/>'
    xx, yy, zz = moments
    tensor = f'<inertia ixx="{xx}" ixy="0" ixz="0" iyy="{yy}" iyz="0" izz="{zz}"/>'
    return f'<link name="{name}"><inertial>{origin}<mass value="{mass}"/>{tensor}</inertial></link>'


def joint(name: str, parent: str, child: str, kind: str = "revolute", inside: str = "") -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}{inside}</joint>'


def robot(*elements: str) -> str:
    """The first element stands on line 2."""
    return "\n".join(['<robot name="arm" version="1.2">', *elements, "</robot>"])


ARM = robot(
    link("base", None),
    link("upper"),
    link("lower"),
    link("carriage"),
    link("flange", None),
    joint("shoulder", "base", "upper"),
    joint("elbow", "upper", "lower", inside='<dynamics damping="0.3" friction="0.2"/>'),
    joint("lift", "lower", "carriage", "prismatic"),
    joint("flange_joint", "carriage", "flange", "fixed"),
)
"""Two revolute joints, a prismatic one, a fixed one."""
