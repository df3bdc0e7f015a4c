"""What sets the simulated stand-in for the experiment apart from its model: sizes that are stated, and chance by seed.

None of the sizes is the paper's, and none was fitted to its Table 5.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from cutpoint.arrays import Array
from cutpoint.mechanics.drives.compliance import Flexspline
from cutpoint.mechanics.drives.friction import Stribeck
from cutpoint.mechanics.drives.kinematic_error import KinematicError
from cutpoint.model.drive import Drive, Harmonic
from cutpoint.model.mechanism import Mechanism
from cutpoint.simulation import Sensors
from cutpoint.studies.paper.bench import DAMPING, PERIOD
from cutpoint.studies.paper.ripple import Ripple

FARTHEST = 2.0
"""Where normal errors are cut, in standard deviations."""

ORDERS = np.array([4.0, 24.0])
"""Of torque ripple, periods a rotor turn, for 4 pole pairs and 12 slots: offsets of the currents, and cogging."""

LOBES = 2
"""Of the wave generator: how often a kinematic error repeats each rotor turn."""


@dataclass(frozen=True)
class Imperfections:
    """Sizes of what the model does not know; zero is none of it.

    Standard deviations: mass, moment (of inertia), stiffness, friction (dry and viscous each) and rotor (inertia) as
    fractions; centroid in m along each axis; encoder_noise in counts.
    motor_share: the largest share of the friction that is on the motor's side; each joint's is uniform from 0 to it.
    kinematic: amplitude of the drives' kinematic error, rad at the joint, LOBES times a rotor turn, phase uniform.
    counts: of the motor's encoder, a rotor turn; 0 is a perfect one.  delay: samples from encoder to torque.
    ripple: amplitude of each of ORDERS, N m at the joint, phases uniform.  damping: of the drives, N m s/rad.
    """

    mass: float = 0.0
    centroid: float = 0.0
    moment: float = 0.0
    stiffness: float = 0.0
    friction: float = 0.0
    motor_share: float = 0.0
    rotor: float = 0.0
    kinematic: float = 0.0
    counts: int = 0
    encoder_noise: float = 0.0
    delay: int = 0
    ripple: tuple[float, float] = (0.0, 0.0)
    damping: float = 0.0

    @property
    def is_random(self) -> bool:
        """Whether seeds make a difference."""
        certain = replace(self, counts=0, delay=0, damping=0.0)
        return certain != Imperfections()

    def only(self, *names: str) -> "Imperfections":
        """These alone."""
        return Imperfections(**{name: getattr(self, name) for name in names})


ALL = Imperfections(
    mass=0.03, centroid=0.003, moment=0.1, stiffness=0.15, friction=0.15, motor_share=1.0, rotor=0.1, kinematic=1.45e-4,
    counts=2**13, encoder_noise=0.25, delay=1, ripple=(0.4, 0.2), damping=DAMPING,
)  # fmt: skip


UNITS = {
    **dict.fromkeys(("mass", "moment", "stiffness", "friction", "motor_share", "rotor"), "fraction"),
    "centroid": "m", "kinematic": "rad", "counts": "per rotor turn", "encoder_noise": "counts", "delay": "samples",
    "ripple": "N m", "damping": "N m s/rad",
}  # fmt: skip


class Chance(NamedTuple):
    """What one seed decides, whatever the sizes: normals, cut, for six links (6, ...) and two drives (2,); uniforms."""

    mass: Array
    centroid: Array
    moment: Array
    stiffness: Array
    dry: Array
    viscous: Array
    rotor: Array
    share: Array
    phases: Array
    error_phases: Array

    @classmethod
    def of(cls, seed: int) -> "Chance":
        rng = np.random.default_rng(seed)
        shapes = ((6,), (6, 3), (6,), (2,), (2,), (2,), (2,))
        normals = [np.clip(rng.standard_normal(shape), -FARTHEST, FARTHEST) for shape in shapes]
        share, phases, error_phases = (rng.random(shape) for shape in ((2,), (len(ORDERS), 2), (2,)))
        return cls(*normals, share=share, phases=2 * np.pi * phases, error_phases=2 * np.pi * error_phases)


def actual_mechanism(nominal: Mechanism, sizes: Imperfections, chance: Chance) -> Mechanism:
    """The arm with the masses that it turns out to have."""
    bodies = [
        replace(
            body,
            mass=body.mass * (1 + sizes.mass * chance.mass[k]),
            com=body.com + sizes.centroid * chance.centroid[k],
            inertia=body.inertia * (1 + sizes.moment * chance.moment[k]),
        )
        for k, body in enumerate(nominal.bodies)
    ]
    return replace(nominal, bodies=tuple(bodies))


def actual_drive(nominal: Drive, sizes: Imperfections, chance: Chance, k: int) -> Drive:
    """The drive of joint k as it turns out to be."""
    spring, friction, rotor = nominal.compliance, nominal.link_friction, nominal.rotor
    assert isinstance(spring, Flexspline) and isinstance(friction, Stribeck) and rotor is not None
    dry, viscous = (1 + sizes.friction * z[k] for z in (chance.dry, chance.viscous))
    share = sizes.motor_share * chance.share[k]
    error = KinematicError((Harmonic(LOBES, sizes.kinematic, chance.error_phases[k]),))
    return replace(
        nominal,
        rotor=replace(rotor, inertia=rotor.inertia * (1 + sizes.rotor * chance.rotor[k])),
        compliance=replace(spring, stiffness=spring.stiffness * (1 + sizes.stiffness * chance.stiffness[k])),
        damping=sizes.damping,
        kinematic_error=error,
        link_friction=_scaled(friction, (1 - share) * dry, (1 - share) * viscous),
        motor_friction=_scaled(friction, share * dry, share * viscous),
    )


def _scaled(law: Stribeck, dry: float, viscous: float) -> Stribeck:
    return replace(law, coulomb=dry * law.coulomb, static=dry * law.static, viscous=viscous * law.viscous)


def ripple_of(sizes: Imperfections, chance: Chance, ratio: Array) -> Ripple:
    amplitudes = np.outer(sizes.ripple, np.ones(len(ratio)))
    return Ripple(ORDERS, amplitudes, chance.phases, ratio)


def sensors_of(sizes: Imperfections, seed: int, ratio: Array) -> Sensors:
    """Motor encoders; speeds are differences of their positions once these come in counts."""
    if not sizes.counts:
        return Sensors(delay=sizes.delay * PERIOD)
    count = 2 * np.pi / sizes.counts / np.abs(ratio)
    noise = sizes.encoder_noise * count if sizes.encoder_noise else None
    return Sensors(
        motor_resolution=count, motor_noise=noise, delay=sizes.delay * PERIOD, speeds="differenced", seed=seed
    )
