"""A three-joint arm in which "follower" mimics "leader", the joints in any order along it."""

LINK = """<link name="{}"><inertial><origin xyz="0.1 0.05 0.02"/><mass value="1.5"/>
<inertia ixx="0.02" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>"""

JOINT = """<joint name="{}" type="revolute"><parent link="l{}"/><child link="l{}"/><axis xyz="0 1 0"/>
<origin xyz="0.3 0 0.1" rpy="0.4 0.2 0"/><limit lower="-3" upper="3" effort="9" velocity="9"/>{}</joint>"""

MIMIC = '<mimic joint="leader" multiplier="-0.7" offset="0.1"/>'


def arm(order: tuple[str, ...]) -> str:
    """The robot's URDF, its joints from the base outward in this order."""
    links = [LINK.format(f"l{k}") for k in range(len(order) + 1)]
    joints = [JOINT.format(name, k, k + 1, MIMIC if name == "follower" else "") for k, name in enumerate(order)]
    return "<robot name='arm'>" + "".join(links + joints) + "</robot>"
