"""The drive file's fields on what bends: compliance, hysteresis, kinematic error."""

from pydantic import Field

from cutpoint.formats.drives.sheet import Sheet, WaveSheet, quantity

MOST_ELEMENTS = 16
"""Of hysteresis, that a file may ask for."""


class LinearSheet(Sheet):
    """A spring of constant stiffness."""

    stiffness: float = quantity("N m/rad", "N/m", "of the spring, at the joint's side", gt=0)


class FlexsplineSheet(Sheet):
    """A flexspline that hardens with load.  Xia (2019) eq. (2)."""

    stiffness: float = quantity("N m/rad", "N/m", "K_f0, unloaded, at the joint's side", gt=0)
    hardening: float = quantity("1/(N m)", "1/N", "c_f: stiffness grows by 1 + (c_f torque)^2", gt=0)


class WaveGeneratorSheet(Sheet):
    """A wave generator that hardens with load, in series with the flexspline.  Xia (2019) eq. (3)."""

    stiffness: float = quantity("N m/rad", "N m/rad", "K_w0, unloaded, at the wave generator", gt=0)
    hardening: float = quantity("1/(N m)", "1/(N m)", "c_w: stiffness grows by exp(c_w torque)", gt=0)
    blend: float = quantity(
        "N m", "N m", "torque at the wave generator below which the law's kink at zero is rounded", 0.01, gt=0
    )


class CatalogueSheet(Sheet):
    """A catalogue's stiffness curve: straight segments with rounded corners."""

    k1: float = quantity("N m/rad", "N/m", "stiffness K1, below t1", gt=0)
    k2: float = quantity("N m/rad", "N/m", "stiffness K2, from t1 to t2", gt=0)
    k3: float = quantity("N m/rad", "N/m", "stiffness K3, beyond t2", gt=0)
    t1: float = quantity("N m", "N", "torque T1 of the first corner", gt=0)
    t2: float = quantity("N m", "N", "torque T2 of the second corner, above t1", gt=0)


class ComplianceSheet(Sheet):
    """The spring between motor and link: exactly one law, the flexspline with its wave generator if wanted."""

    linear: LinearSheet | None = Field(None, description="a spring of constant stiffness")
    flexspline: FlexsplineSheet | None = Field(None, description="a flexspline that hardens with load, eq. (2)")
    wave_generator: WaveGeneratorSheet | None = Field(
        None, description="the wave generator's own compliance, in series with `flexspline`, eq. (3)"
    )
    catalogue: CatalogueSheet | None = Field(None, description="the stiffness curve of a catalogue, corners rounded")


class HysteresisSheet(Sheet):
    """Slipping elements in parallel to the spring, by the loop that they open."""

    loss: float = quantity(
        "rad", "m", "width of the torque-deflection loop at zero torque: the catalogue's hysteresis loss", gt=0
    )
    reach: float | None = quantity(
        "rad", "m", "deflection after a reversal over which the loop opens; `loss` if not stated", None, gt=0
    )
    elements: float = quantity(
        "1", "1", "number of elements, each a state of the simulation", 4.0, ge=1, le=MOST_ELEMENTS
    )


class KinematicErrorSheet(WaveSheet):
    """By how much the unloaded output lags ratio-true rotation: waves over the wave generator's turn."""

    amplitude: float = quantity("rad", "m", "half of the catalogue's transmission accuracy, at the joint's side", ge=0)
    order: float = quantity("1", "1", "waves for each turn of the wave generator, a whole number", 2.0, ge=1)
