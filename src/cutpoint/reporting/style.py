"""Common style of all figures of a report: type, colours, sizes."""

from collections.abc import Callable
from io import BytesIO
from typing import Any

from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.text import Text

INK = "#1d1d1f"
FAINT = "#8a8f98"
HAIR = "#d5d8dd"
MOTOR, MOTOR_FILL = "#1f5fa8", "#d6e5f5"
LINK, LINK_FILL = "#c2571a", "#fbe3d0"
BASE, BASE_FILL = "#5b6270", "#e6e8ec"
SPRING, SPRING_FILL = "#2a7f4f", "#d3ecdd"
FORCE = "#b01e3c"
JOINTS = ("#1f5fa8", "#c2571a", "#2a7f4f", "#8a4fa3", "#b8860b", "#4a4f57")
"""One colour per joint, the same in every figure, dark enough to read on white."""

WIDTH = 9.0
"""Width of a full figure in inches; text of 11 points then has the size of the page's text."""

ACROSS = 3
"""Most panels side by side."""

STYLE: Any = {
    "font.family": ["STIXGeneral", "DejaVu Sans"],
    "mathtext.fontset": "stix",
    "font.size": 12,
    "axes.titlesize": 12,
    "axes.titlelocation": "left",
    "axes.edgecolor": FAINT,
    "axes.labelcolor": INK,
    "axes.grid": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.8,
    "grid.color": HAIR,
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.5,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.labelsize": 10,
    "ytick.labelsize": 10,
    "text.color": INK,
    "legend.frameon": False,
    "legend.fontsize": 11,
    "hatch.linewidth": 0.5,
    "figure.dpi": 160,
    "savefig.dpi": 160,
}


def styled() -> Any:
    """A context for making and saving figures in this style; matplotlib's settings are restored afterwards."""
    return rc_context(STYLE)


def styled_figure(draw: Callable[[], Figure]) -> Figure:
    """A figure in this style, laid out at once: what is laid out later takes the style of that moment."""
    with styled():
        figure = draw()
        figure.draw_without_rendering()
        return figure


def grid_of(panels: int) -> tuple[int, int]:
    """Rows and columns of a figure with so many panels: at most ACROSS side by side, rows as full as they can be."""
    down = -(-panels // ACROSS)
    return down, -(-panels // down)


def width_of(text: Text) -> float:
    """Inches, as it will be drawn."""
    figure: Any = text.get_figure()
    return float(text.get_window_extent().width / figure.dpi)


def fit(text: Text, width: float) -> None:
    """Shrinks a text that is wider than this, in inches."""
    if (found := width_of(text)) > width:
        text.set_fontsize(float(text.get_fontsize()) * width / found)


def png(figure: Figure) -> bytes:
    """The figure as a PNG without date or version: the same drawing gives the same bytes."""
    buffer = BytesIO()
    figure.savefig(buffer, format="png", metadata={"Software": None}, facecolor="white")
    return buffer.getvalue()
