"""Large robots: their equations as loops over bodies, compiled once for a tree of any size."""

from cutpoint.rolled.alone import JointByJoint, joint_by_joint
from cutpoint.rolled.functions import TOO_LARGE, RolledFunction, loops_take, name_of, rolled
from cutpoint.rolled.recipes import DERIVATIVES, RECIPES
from cutpoint.rolled.suited import check_compiles

__all__ = [
    "DERIVATIVES", "RECIPES", "TOO_LARGE", "JointByJoint", "RolledFunction", "check_compiles", "joint_by_joint",
    "loops_take", "name_of", "rolled",
]  # fmt: skip
