"""Figure 12: the arm at the start, in the middle and at the end of the run of section IV.C."""

import numpy as np
from matplotlib.figure import Figure

from cutpoint.arrays import Array
from cutpoint.reporting.style import WIDTH
from cutpoint.robots import xia2019_mechanism
from cutpoint.studies.paper.arm_view import draw_arm, draw_legend, view
from cutpoint.studies.paper.chain import chain_of

_ROOM = ((-0.25, -0.25, 0.0), (1.25, 1.0, 1.0))


def figure_12(poses: Array, times: Array) -> Figure:
    """poses (3, 2): joints 1 and 2 in rad, the others at zero; times (3,) in s."""
    figure = Figure(figsize=(WIDTH, 3.4))
    chain = chain_of(xia2019_mechanism())
    for k, (pose, time) in enumerate(zip(poses, times, strict=True)):
        axes = view(figure, (k / 3, 0.04, 1 / 3, 0.94), _ROOM, zoom=1.06)
        draw_arm(axes, chain, np.concatenate([pose, np.zeros(4)]))
        first, second = np.rad2deg(pose).round(1) + 0.0  # no minus before a zero
        figure.text(k / 3 + 0.02, 0.93, f"({'abc'[k]})  {time:g} s: {first:.1f}°, {second:.1f}°", weight="bold")
    draw_legend(figure)
    return figure
