"""A universal joint as two revolute joints with a massless cross between them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cutpoint.model.mechanism import Joint, Link


def expanded(links: Sequence[Link], joints: Sequence[Joint]) -> tuple[list[Link], list[Joint]]:
    """Links and joints with every universal joint `j` as the revolute joints `j_1` and `j_2` and the link `j_cross`.

    Both axes pass through the joint's origin, the second in the frame that the first has turned.  Both inherit limits,
    damping and friction.
    """
    crosses, simple = [], []
    for joint in joints:
        if joint.kind == "universal":
            crosses.append(Link(f"{joint.name}_cross"))
            simple += _halves(joint, crosses[-1].name)
        else:
            simple.append(joint)
    return [*links, *crosses], simple


def _halves(joint: Joint, cross: str) -> list[Joint]:
    """`second_axis` is of unit length by now, as `axis` is."""
    assert joint.second_axis is not None
    first = replace(joint, name=f"{joint.name}_1", kind="revolute", child=cross, second_axis=None)
    second = replace(
        first, name=f"{joint.name}_2", parent=cross, child=joint.child, placement=np.eye(4), axis=joint.second_axis
    )
    return [first, second]
