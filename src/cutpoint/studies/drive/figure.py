"""A drive of the catalogue in four panels: stiffness, accuracy, running torque, efficiency."""

from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from cutpoint.files import save_figure
from cutpoint.reporting.style import WIDTH, styled
from cutpoint.studies.drive.angles import accuracy, stiffness
from cutpoint.studies.drive.losses import efficiency, running_torque
from cutpoint.studies.drive.measured import Specimen


def save_picture(name: str, path: Path) -> None:
    """The four panels as a file.  Raises ModelError for a name that is not in the catalogue."""
    with styled():
        save_figure(picture(name), path)


def picture(name: str) -> Figure:
    """The four panels.  Errors as in `save_picture`."""
    specimen = Specimen(name)
    figure = Figure(figsize=(WIDTH, 7.6), layout=ConstrainedLayoutEngine(w_pad=0.08, h_pad=0.08))
    panels = figure.subplot_mosaic([["a", "b"], ["a", "spectrum"], ["c", "d"]], height_ratios=(3, 2, 5.5))
    stiffness(panels["a"], specimen)
    accuracy(panels["b"], panels["spectrum"], specimen)
    running_torque(panels["c"], specimen)
    efficiency(panels["d"], specimen)
    gear = specimen.gear
    figure.suptitle(
        f"{gear.name}    {gear.maker}, size {gear.size}, ratio {gear.ratio}", x=0.02, ha="left", fontsize=14
    )
    return figure
