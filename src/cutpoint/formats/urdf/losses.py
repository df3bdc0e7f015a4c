"""Parts of a URDF that are not read and would change the dynamics."""

from collections import Counter
from collections.abc import Collection

from cutpoint.errors import listed
from cutpoint.formats.reading import parse_number
from cutpoint.formats.safe_xml import Element
from cutpoint.formats.urdf.elements import name_of

OF_DRAKE = ("loop_joint", "force_element", "ball_constraint", "linear_bushing_rpy", "linear_spring_damper")
"""Elements beside the tree that constrain or push its bodies."""


def losses(robot: Element, moving: Collection[str]) -> list[str]:
    """What other programs would read of a robot, for a warning.  moving: its joints that move."""
    return [*_lost_beside_the_tree(robot), *_lost_rotors(robot, moving), *_lost_friction(robot, moving)]


def _lost_beside_the_tree(robot: Element) -> list[str]:
    """What would constrain or push its bodies in Drake, and joints of Gazebo's own, which close loops."""
    found = Counter(child.tag.rpartition("}")[2] for child in robot.children)
    closing = sum(1 for extension in robot.all("gazebo") for _ in extension.all("joint"))
    lost = [f"<{tag}> ({found[tag]})" for tag in OF_DRAKE if found[tag]]
    return lost + ([f"<joint> in <gazebo> ({closing})"] if closing else [])


def _lost_rotors(robot: Element, moving: Collection[str]) -> list[str]:
    """Moving joints whose rotors count in other programs: by armature, or by a transmission's rotor inertia."""
    found = [
        name_of(joint)
        for joint in robot.all("joint")
        for dynamics in joint.all("dynamics")
        if _is_stated(dynamics, "armature")
    ]
    for transmission in robot.all("transmission"):
        if any(x.tag.endswith("rotor_inertia") and _is_stated(x, "value") for x in transmission.walk()):
            found += [name_of(joint) for joint in transmission.all("joint")]
    lost = [name for name in dict.fromkeys(found) if name in moving]
    return [f"rotor inertia of joints {listed(lost)}: rotor and ratio in a drive file count instead"] if lost else []


def _lost_friction(robot: Element, moving: Collection[str]) -> list[str]:
    """Moving joints with the element that early URDF had for <dynamics>, and that programs since then pass over."""
    lost = [
        name
        for joint in robot.all("joint")
        for old in joint.all("joint_properties")
        if (name := name_of(joint)) in moving and (_is_stated(old, "damping") or _is_stated(old, "friction"))
    ]
    return [f"<joint_properties> of joints {listed(lost)}: state it in <dynamics>"] if lost else []


def _is_stated(element: Element, attribute: str) -> bool:
    return (parse_number(element.attributes.get(attribute, "").strip()) or 0.0) != 0.0
