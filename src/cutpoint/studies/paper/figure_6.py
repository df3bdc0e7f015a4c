"""Figure 6: the arm to scale with the frames of its joints, at zero and at the end of (57)."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from mpl_toolkits.mplot3d import Axes3D

from cutpoint.robots import xia2019_mechanism
from cutpoint.studies.chain import Array, Chain, chain_of, places
from cutpoint.studies.paper.printed import GOAL, LENGTHS
from cutpoint.studies.style import FAINT, INK, LINK, MOTOR, SPRING, WIDTH

_TRIAD = 0.13  # m
_AXES = (FAINT, SPRING, MOTOR)
_NAMES = {0: "{B$_1$}", 1: "{B$_2$}", 2: "{B$_3$}, {B$_4$}", 4: "{B$_5$}, {B$_6$}"}
"""Frames by the joint at whose origin they are: 3 and 4 share the elbow, 5 and 6 the wrist."""


def figure_6() -> Figure:
    figure = Figure(figsize=(WIDTH, 4.9))
    chain = chain_of(xia2019_mechanism())
    panels = ((np.zeros(6), "(a) q = 0, where (57) starts"), (GOAL, "(b) where (57) ends"))
    for k, (q, title) in enumerate(panels):
        axes = figure.add_axes((0.5 * k - 0.03, 0.03, 0.56, 0.92), projection="3d")
        assert isinstance(axes, Axes3D)
        _arm(axes, chain, q, with_lengths=k == 0)
        _room(axes)
        figure.text(0.5 * k + 0.02, 0.94, title, weight="bold")
    _legend(figure)
    return figure


def _arm(axes: Axes3D, chain: Chain, q: Array, with_lengths: bool) -> None:
    at = places(chain, q)
    tool = at.origins[5] + LENGTHS["l_4"] * at.rotations[5][:, 2]
    axes.plot(*np.vstack([at.origins, tool]).T, color=LINK, lw=6, alpha=0.35, solid_joinstyle="round")
    axes.plot(*at.centroids.T, "x", color=INK, ms=6, mew=1.6, ls="none")
    for R, origin in zip(at.rotations, at.origins, strict=True):
        for column, colour in enumerate(_AXES):
            axes.quiver(*origin, *(_TRIAD * R[:, column]), color=colour, lw=1.5, arrow_length_ratio=0.25)
    for joint, name in _NAMES.items():
        axes.plot(*at.origins[joint][:, None], "o", mec=INK, mfc="white", ms=7)
        _label(axes, at.origins[joint], name)
    _label(axes, tool, "{O}")
    if with_lengths:
        _lengths(axes, [at.origins[0], at.origins[1], at.origins[2], at.origins[4], tool])


def _label(axes: Axes3D, at: Array, name: str) -> None:
    axes.text(at[0], at[1], at[2] - 0.15, name, ha="center", fontsize=11)


def _lengths(axes: Axes3D, corners: list[Array]) -> None:
    for start, end, name in zip(corners[:-1], corners[1:], LENGTHS, strict=True):
        middle = (start + end) / 2 + np.array([0.0, 0.0, 0.06 if start[2] == end[2] else 0.0])
        axes.text(*middle, f"${name}$", color=LINK, ha="center", fontsize=13)


def _room(axes: Axes3D) -> None:
    axes.set(xlim=(-0.2, 1.1), ylim=(-0.45, 0.75), zlim=(0.0, 1.1))
    axes.set_box_aspect((1.3, 1.2, 1.1), zoom=1.18)
    axes.view_init(elev=20, azim=-62)
    for name, axis in (("x", axes.xaxis), ("y", axes.yaxis), ("z", axes.zaxis)):
        axis.set_ticks([0.0, 0.5, 1.0] if name != "y" else [0.0, 0.5])
        axis.set_pane_color((1, 1, 1, 0))
        axis.set_label_text(f"${name}$ [m]")
        axis.labelpad = -6
        axis.set_tick_params(labelsize=9, pad=-2)


def _legend(figure: Figure) -> None:
    lines = [Line2D([], [], color=colour, lw=2) for colour in _AXES]
    lines.append(Line2D([], [], color=INK, marker="x", ls="none", mew=1.6))
    names = ["$x$", "$y$", "$z$: the joint's axis", "centroid of a link"]
    figure.legend(lines, names, loc="lower center", ncols=4)
