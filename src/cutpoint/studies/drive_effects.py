"""Drives of the arm with the effects of real ones, each switched on or off by its numbers."""

from collections.abc import Collection
from dataclasses import replace

from cutpoint.formats.catalogue.catalogue import catalogue_drive
from cutpoint.mechanics.drives.catalogue import CatalogueSpring
from cutpoint.mechanics.drives.friction import STATED_AT, Coulomb, Grease
from cutpoint.mechanics.drives.hysteresis import MaxwellSlip
from cutpoint.mechanics.drives.kinematic_error import KinematicError
from cutpoint.mechanics.drives.presliding import ElastoPlastic
from cutpoint.model.drive import Drive, Harmonic, Motor
from cutpoint.robot import Robot

GEARS = ("CSG-20-100", "CSG-20-100", "CSG-17-100", "CSG-17-100", "CSG-14-100", "CSG-14-100")
"""Of joints 1 to 6, in the package's catalogue.  The arm's drive file takes these sizes for its springs."""

STIFFNESS, ERROR, HYSTERESIS, FRICTION = "stiffness curve", "kinematic error", "hysteresis", "gear friction"
PRESLIDING, LAG, RIPPLE = "presliding", "current loop and delay", "torque ripple and cogging"
ASYMMETRY, COLD = "asymmetric friction", "cold grease"
EFFECTS = (STIFFNESS, ERROR, HYSTERESIS, FRICTION, PRESLIDING, LAG, RIPPLE, ASYMMETRY, COLD)
"""Effects in the order in which they are switched on."""

NEEDS = {PRESLIDING: FRICTION, ASYMMETRY: FRICTION, COLD: FRICTION}
"""The effect that each of these modifies, and therefore requires."""

DISTANCE, BRISTLE_DAMPING, ELASTIC = 5e-4, 3.0, 0.7
"""Of presliding: rad at the joint (a twentieth of a radian of the motor), N m s/rad, share.  Ours."""

BANDWIDTH, DELAY = 500.0, 1e-4
"""Of the current loops, Hz, and before them, s.  Ours."""

RIPPLE_WAVES = (Harmonic(8, 0.014), Harmonic(24, 0.006))
"""Twice and six times the pole pairs, of which there are 4: unequal phases, and waves of the back-EMF.  2 % in all."""

COGGING_ORDER, COGGING = 24, 0.005
"""Of 8 poles and 12 slots; N m at the shaft for each N m of the gear's rated torque there.  Ours."""

LEANING = 0.1
"""Dry friction is this much of itself larger forwards, and smaller backwards.  Ours."""

TEMPERATURE, THINNING = 0.0, 0.03
"""Of cold grease, deg C, and how viscous friction follows it, 1/K: about twice as much as at 25 deg C.  Ours."""

_NO_STIFFNESS = 1e-9
"""N m/rad: what stands for none, since an element must have some; it exerts less than rounding does."""


def with_effects(arm: Robot, on: Collection[str], rubs: float = 1.0) -> Robot:
    """The arm on drives with these effects and what they need; with none, on linear springs alone.

    All have the same laws, as far as numbers can switch one off, so that few loops need compiling.
    rubs: factor on the gears' friction.
    """
    named = {*on, *(NEEDS[effect] for effect in on if effect in NEEDS)}
    drives = arm.drives.items()
    return arm.with_drives(
        {name: drive_with(drive, gear, named, rubs) for (name, drive), gear in zip(drives, GEARS, strict=True)}
    )


def drive_with(nominal: Drive, gear: str, on: Collection[str], rubs: float = 1.0) -> Drive:
    """One drive: ratio and rotor are the arm's, the laws those of the catalogue's gear."""
    maker = catalogue_drive(gear)
    assert isinstance(maker.compliance, CatalogueSpring)
    assert isinstance(maker.hysteresis, MaxwellSlip)
    assert isinstance(maker.kinematic_error, KinematicError)
    assert isinstance(maker.motor_friction, Coulomb)
    spring, error, hysteresis = maker.compliance, maker.kinematic_error, maker.hysteresis
    if STIFFNESS not in on:
        spring = replace(spring, k2=spring.k1, k3=spring.k1)
    if ERROR not in on:
        error = KinematicError(tuple(replace(wave, amplitude=0.0) for wave in error.harmonics))
    if HYSTERESIS not in on:
        hysteresis = replace(hysteresis, stiffness=(_NO_STIFFNESS,) * len(hysteresis.reach))
    friction = sliding_friction(maker.motor_friction, on, rubs)
    return replace(
        nominal,
        compliance=spring,
        kinematic_error=error,
        hysteresis=hysteresis,
        link_friction=None,
        motor_friction=ElastoPlastic(friction, DISTANCE, BRISTLE_DAMPING, ELASTIC) if PRESLIDING in on else friction,
        motor=motor_with(maker, on),
        ratings=maker.ratings,
    )


def sliding_friction(law: Coulomb, on: Collection[str], rubs: float) -> Coulomb:
    """A gear's friction once it slides, at the joint's side."""
    assert law.per_load is not None
    size = rubs if FRICTION in on else 0.0
    return replace(
        law,
        coulomb=size * law.coulomb,
        viscous=size * law.viscous,
        per_load=size * law.per_load,
        asymmetry=LEANING if ASYMMETRY in on else 0.0,
        grease=Grease(TEMPERATURE if COLD in on else float(STATED_AT), THINNING),
    )


def motor_with(maker: Drive, on: Collection[str]) -> Motor:
    """A motor without limits; its torque constant does not matter then."""
    assert maker.ratings is not None and maker.ratings.rated_torque is not None
    size = 1.0 if RIPPLE in on else 0.0
    cogging = COGGING * maker.ratings.rated_torque / abs(maker.ratio)
    motor = Motor(
        torque_constant=0.1,
        ripple=tuple(replace(wave, amplitude=size * wave.amplitude) for wave in RIPPLE_WAVES),
        cogging=(Harmonic(COGGING_ORDER, size * cogging),),
    )
    return replace(motor, bandwidth=BANDWIDTH, delay=DELAY) if LAG in on else motor


def detent_stiffness(nominal: Drive, gear: str) -> float:
    """Of cogging at its steepest, at the joint, N m/rad: a motor on a softer feedback snaps from tooth to tooth."""
    motor = drive_with(nominal, gear, (RIPPLE,)).motor
    assert motor is not None
    return nominal.ratio**2 * sum(abs(wave.order * wave.amplitude) for wave in motor.cogging)
