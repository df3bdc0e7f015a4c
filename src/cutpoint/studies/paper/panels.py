"""Six panels over time, one per joint, as in the paper."""

from matplotlib.axes import Axes
from matplotlib.figure import FigureBase


def six_panels(figure: FigureBase, quantity: str, unit: str) -> list[Axes]:
    """2 x 3 panels on a figure, each named; y axes carry the quantity and its unit."""
    panels = list(figure.subplots(2, 3, sharex=True).flat)
    for k, axes in enumerate(panels):
        axes.set_title(f"joint {k + 1}")
        axes.margins(x=0)
        if k % 3 == 0:
            axes.set_ylabel(f"{quantity} [{unit}]")
        if k >= 3:
            axes.set_xlabel("time [s]")
    return panels
