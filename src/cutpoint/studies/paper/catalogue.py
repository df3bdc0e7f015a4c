"""The drives of the arm against a maker's catalogue: law (2) and the stiffness of three sizes."""

from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import least_squares

from cutpoint.arrays import Array
from cutpoint.mechanics.drives.catalogue import CatalogueSpring
from cutpoint.mechanics.drives.compliance import Flexspline
from cutpoint.model.units import ARC_MINUTE
from cutpoint.reporting.page import Page, Picture, Table, number
from cutpoint.reporting.style import INK, LINK, MOTOR, SPRING, WIDTH
from cutpoint.studies.paper.bench import Bench


class Size(NamedTuple):
    """Torsional stiffness at ratios above 50.  Harmonic Drive LLC, CHA actuator manual 1018854, tables 50.4 and 54.4.

    T1 and T2 in N m; K1 up to T1, K2 from there to T2 and K3 beyond, in N m/rad.  joints: where the arm has this size.
    """

    number: int
    T1: float
    T2: float
    K1: float
    K2: float
    K3: float
    joints: tuple[int, ...]

    def deflection(self, torque: Array) -> Array:
        """Of the catalogue's broken line, rad."""
        line = CatalogueSpring(self.K1, self.K2, self.K3, self.T1, self.T2)
        return np.asarray(line.straight_deflection(torque))


SIZES = (
    Size(20, 7.0, 25.0, 16e3, 25e3, 29e3, (1, 2)),
    Size(17, 3.9, 12.0, 10e3, 14e3, 16e3, (3, 4)),
    Size(14, 2.0, 6.9, 4.7e3, 6.1e3, 7.1e3, (5, 6)),
)


def page(bench: Bench) -> Page:
    laws = {size: law_of(bench, size) for size in SIZES}
    fits = {size: fitted(size) for size in SIZES}
    reached = bench.elastic.max("joint_torque")
    largest = {size: max(reached[k - 1] for k in size.joints) for size in SIZES}
    blocks = (
        "The paper says that the constants of law (2) were obtained as in its reference [26] and prints none. The "
        "arm's drive file therefore takes three sizes from a catalogue, which prints stiffness as a broken line of "
        "three slopes; the choice of sizes is ours. The catalogue's figures include the wave generator, so (3) adds "
        "nothing. K_{f0} is the catalogue's first slope, and c_{f} is such that (2) meets the line at T_{2}.",
        _table(laws, fits, largest),
        _verdict(laws, largest),
        Picture(
            "Figure A3",
            "Above: law (2) as shipped, a least-squares fit of both constants up to T_{2}, and the "
            "catalogue with its corners T_{1} and T_{2}. Below: deflection of the law less that of the "
            "catalogue.",
            _figure(laws, fits),
        ),
    )
    return Page("drive", "The drive: law (2) and a catalogue", blocks, _results(laws, fits, largest))


def law_of(bench: Bench, size: Size) -> Flexspline:
    """What the arm's drive file has for this size."""
    law = bench.robot.drives[f"joint{size.joints[0]}"].compliance
    assert isinstance(law, Flexspline)
    return law


def fitted(size: Size) -> Flexspline:
    """Both constants of (2) by least squares of the deflection from 0 to T2."""
    torque = np.linspace(0, size.T2, 200)

    def misfit(x: Array) -> Array:
        return departure(Flexspline(1e4 * x[0], x[1]), size, torque)

    return Flexspline(*(least_squares(misfit, [1e-4 * size.K1, 0.05]).x * [1e4, 1.0]))


def departure(law: Flexspline, size: Size, torque: Array) -> Array:
    """Deflection of the law less that of the catalogue, arc minutes."""
    return (law.deflection(torque) - size.deflection(torque)) / ARC_MINUTE


def worst(law: Flexspline, size: Size) -> float:
    """Largest departure up to T2, arc minutes."""
    return float(np.abs(departure(law, size, np.linspace(0, size.T2, 500))).max())


def _table(laws: dict[Size, Flexspline], fits: dict[Size, Flexspline], largest: dict[Size, float]) -> Table:
    def line(size: Size) -> tuple[str, ...]:
        law, fit, torque = laws[size], fits[size], largest[size]
        return (
            f"{size.number}",
            f"{size.joints[0]}, {size.joints[1]}",
            f"{law.stiffness:.0f}",
            f"{law.hardening:.4f}",
            f"{worst(law, size):.2f}",
            f"{fit.stiffness:.0f}",
            f"{fit.hardening:.4f}",
            f"{worst(fit, size):.2f}",
            f"{torque:.1f} of {size.T2:g}",
            number(float(departure(law, size, np.array(torque))), 2),
        )

    columns = (
        "size",
        "joints",
        "K_{f0} [N m/rad]",
        "c_{f} [1/(N m)]",
        "departs by [arcmin]",
        "fit: K_{f0}",
        "c_{f}",
        "departs by",
        "largest torque of T_{2} [N m]",
        "departs there by",
    )
    return Table(
        "Table A2",
        "Law (2) against the catalogue from 0 to T_{2}, and at the largest torque of Table 4's loop.",
        columns,
        tuple(line(size) for size in SIZES),
    )


def _verdict(laws: dict[Size, Flexspline], largest: dict[Size, float]) -> str:
    departures = ", ".join(f"{worst(laws[size], size):.2f}" for size in SIZES)
    beyond = [size for size in SIZES if largest[size] > size.T2]
    there = ", ".join(f"{-departure(laws[size], size, np.array(largest[size])):.2f}" for size in beyond)
    return (
        f"Up to T_{{2}} the shipped laws depart from the broken line by at most {departures} arc minutes, less than "
        "the arc minute of hysteresis that the same catalogue allows. Beyond T_{2} law (2) goes on stiffening where "
        f"the catalogue does not. {len(beyond)} of the 3 sizes are loaded beyond it here; at their largest torque they "
        f"bend {there} arc minutes less than their maker says."
    )


def _figure(laws: dict[Size, Flexspline], fits: dict[Size, Flexspline]) -> Figure:
    figure = Figure(figsize=(WIDTH, 5.2), layout="constrained")
    panels = figure.subplots(2, 3, sharex="col", height_ratios=(2, 1))
    for k, size in enumerate(SIZES):
        torque, corners = np.linspace(0, 1.5 * size.T2, 300), np.array([size.T1, size.T2])
        above, below = panels[:, k]
        above.plot(torque, size.deflection(torque) / ARC_MINUTE, color=INK, lw=1.0, label="catalogue")
        above.plot(corners, size.deflection(corners) / ARC_MINUTE, "o", color=INK, ms=5)
        for law, colour, line, name in (
            (laws[size], MOTOR, "-", "law (2), shipped"),
            (fits[size], LINK, "--", "law (2), fitted"),
        ):
            above.plot(torque, law.deflection(torque) / ARC_MINUTE, line, color=colour, label=name)
            below.plot(torque, departure(law, size, torque), line, color=colour)
        for axes in (above, below):
            axes.axvspan(size.T2, 1.5 * size.T2, color=SPRING, alpha=0.08, lw=0)
            axes.margins(x=0)
        above.set_title(f"size {size.number}, joints {size.joints[0]} and {size.joints[1]}")
        below.set_xlabel("torque [N m]")
    panels[0, 0].set_ylabel("deflection [arcmin]")
    panels[1, 0].set_ylabel("departure [arcmin]")
    panels[0, 0].legend(loc="upper left")
    panels[0, 2].text(
        0.97, 0.05, "shaded: beyond T$_2$", transform=panels[0, 2].transAxes, ha="right", fontsize=10, color=SPRING
    )
    return figure


def _results(
    laws: dict[Size, Flexspline], fits: dict[Size, Flexspline], largest: dict[Size, float]
) -> dict[str, dict[str, object]]:
    def described(law: Flexspline, size: Size) -> dict[str, float]:
        return {"stiffness": law.stiffness, "hardening": law.hardening, "departure": worst(law, size)}

    rows = {
        f"size {size.number}": {
            "joints": size.joints,
            "catalogue": {"T1": size.T1, "T2": size.T2, "K1": size.K1, "K2": size.K2, "K3": size.K3},
            "shipped": described(laws[size], size),
            "fitted": described(fits[size], size),
            "largest_torque": largest[size],
        }
        for size in SIZES
    }
    return {
        "table_a2": {
            "units": {"stiffness": "N m/rad", "hardening": "1/(N m)", "departure": "arcmin", "torque": "N m"},
            "sizes": rows,
        }
    }
