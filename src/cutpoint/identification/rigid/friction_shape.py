"""Shapes of friction laws over speed, fitted together with all linear unknowns, and robust to outliers.

Where a joint reverses or shakes, filtered speeds carry little information about friction, and a few torques are far
off.  Squared, these alone would determine the shape: Huber's weights bound them, in Gauss-Newton steps.
"""

from collections.abc import Collection, Mapping

import numpy as np

from cutpoint.arrays import Array
from cutpoint.identification.conditioning.motion import sliding_speeds
from cutpoint.identification.rigid.base_parameters import BaseParameters
from cutpoint.identification.rigid.law_shape import is_sharp, moved, shape_of, widest_smoothing
from cutpoint.identification.rigid.least_squares import huber_weights, solved, weighted
from cutpoint.identification.rigid.regression import Regression, inertial_columns, of_joint, regression
from cutpoint.identification.rigid.rigid_estimate import TorqueData
from cutpoint.identification.rigid.rigid_robot import laws_with
from cutpoint.mechanics.drives.friction import Sliding

Laws = Mapping[str, Sliding]
Shape = tuple[str, str]
"""A joint, and the name of a shape parameter of its law."""

STEPS = 12
LONGEST = 0.3
"""Longest step, in the logarithm of a speed."""

SETTLED = 1e-3
NEARLY = 0.05
"""Largest last step: a law that still changes by more is left as it was, as its shape is undetermined."""

CHANGE = 1e-4
"""Step for derivatives, in the logarithm of a speed."""


def best_shapes(
    base: BaseParameters, laws: Laws, joints: Collection[str], log: TorqueData, offsets: bool
) -> dict[str, Sliding]:
    """The laws, with the shapes that explain the torques best for some joints.

    offsets: whether each torque may have a constant offset; this and an asymmetry differ only at rest, so that each
    could cancel the other: asymmetries then stay as they are.
    """
    inertial = inertial_columns(base, log.motion, log.means)
    found, steps = dict(laws), dict[Shape, float]()
    for _ in range(STEPS if joints else 0):
        linear = regression(
            base, found, log.motion, log.torque, log.means, offsets=offsets, loads=log.loads, inertial=inertial
        )
        steps = _steps(base, found, joints, log, linear, offsets)
        for (joint, name), step in steps.items():
            found[joint] = moved(found[joint], {name: step})
        if max(map(abs, steps.values())) < SETTLED:
            break
    speeds = dict(zip(base.robot.joints, sliding_speeds(base.robot, log.motion).T, strict=True))
    lost = {
        joint
        for (joint, _), step in steps.items()
        if abs(step) > NEARLY or not is_sharp(found[joint], widest_smoothing(speeds[joint]))
    }
    return {joint: laws[joint] if joint in lost else law for joint, law in found.items()}


def _steps(
    base: BaseParameters,
    laws: Laws,
    joints: Collection[str],
    log: TorqueData,
    linear: Regression,
    offsets: bool,
) -> dict[Shape, float]:
    """Gauss-Newton step of each shape."""
    weights, _ = huber_weights(linear)
    values = solved(*weighted(linear, weights))[0]
    laws = laws_with(laws, dict(zip(linear.names, values.tolist(), strict=True)))
    shapes, slopes = shape_slopes(base, laws, joints, log)
    sought = [k for k, (_, name) in enumerate(shapes) if not (offsets and name == "asymmetry")]
    shapes, slopes = [shapes[k] for k in sought], slopes[..., sought]
    steps = solved(*weighted(linear.with_columns(slopes), weights))[0][-len(shapes) :]
    return dict(zip(shapes, np.clip(steps, -LONGEST, LONGEST).tolist(), strict=True))


def shape_slopes(
    base: BaseParameters, laws: Laws, joints: Collection[str], log: TorqueData
) -> tuple[list[Shape], Array]:
    """The k shape parameters of some joints' laws, and derivatives (M, n, k) of the torques by them."""
    shapes = [(joint, name) for joint in joints for name in shape_of(laws[joint])]
    order, speeds = base.robot.joints, sliding_speeds(base.robot, log.motion)
    found: list[Array] = [np.empty((log.means.size, len(order), 0))]
    for joint, name in shapes:
        j = order.index(joint)
        ends = [moved(laws[joint], {name: x}).torque(speeds[:, j], log.loads[:, j]) for x in (CHANGE, -CHANGE)]
        slope = log.means((ends[0] - ends[1]) / (2.0 * CHANGE))
        found.append(of_joint(slope[:, None], j, len(order)))
    return shapes, np.concatenate(found, axis=2)
