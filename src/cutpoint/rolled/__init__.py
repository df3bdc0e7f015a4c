"""Large robots: their equations as loops over bodies, compiled once for a tree of any size.

A function is a list of passes: steps of `mechanics` for every body, alone, outward, inward, or for pairs of bodies.  A
body is a row of numbers.  `algorithms.inverse` is the first to read, beside `mechanics.inverse_dynamics`, whose sweeps
it repeats.

passes: what a pass is, and how passes become loops.  bodies, drives, subsystem: a body as a row, and back.
packing: motions, wrenches and inertias as rows.
algorithms: inverse, forward, mass, derivatives, ... as passes; `recipes` lists them.  placing, motions, base: what they
share; a floating base has several axes, and runs once.
runs, batches, memory: loops on one configuration, and on many.  sums: rows for what bodies carry.
functions: what a Robot calls.  suited: when.
equations: solvers for the mass matrix of a large robot.  alone: functions in which every joint is by itself.
"""

from cutpoint.rolled.alone import JointByJoint, joint_by_joint
from cutpoint.rolled.functions import TOO_LARGE, RolledFunction, loops_take, name_of, rolled
from cutpoint.rolled.recipes import DERIVATIVES, RECIPES
from cutpoint.rolled.suited import check_compiles

__all__ = [
    "DERIVATIVES", "RECIPES", "TOO_LARGE", "JointByJoint", "RolledFunction", "check_compiles", "joint_by_joint",
    "loops_take", "name_of", "rolled",
]  # fmt: skip
