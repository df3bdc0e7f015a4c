"""Stated properties of a spring that two encoders do not determine: play, a wave generator, the stated loop width."""

from dataclasses import replace

from cutpoint.mechanics.drives.backlash import Backlash, spring_of
from cutpoint.mechanics.drives.hysteresis import MaxwellSlip, loss_of
from cutpoint.mechanics.drives.wave_generator import HarmonicSpring
from cutpoint.model.drive import Compliance, Drive, Hysteresis


def law_of(compliance: Compliance | None) -> Compliance | None:
    """The law whose parameters are sought: without play, and without a wave generator in series."""
    spring = spring_of(compliance)
    return spring.flexspline if isinstance(spring, HarmonicSpring) else spring


def with_spring(drive: Drive, found: Compliance) -> Drive:
    """The drive with another spring behind the same play, and hysteresis that opens loops as wide as before."""
    compliance = replace(drive.compliance, spring=found) if isinstance(drive.compliance, Backlash) else found
    return replace(drive, compliance=compliance, hysteresis=as_wide(drive.hysteresis, drive.compliance, compliance))


def as_wide(law: Hysteresis | None, before: Compliance | None, after: Compliance | None) -> Hysteresis | None:
    """Elements whose loops are as wide, rad, as beside another spring: files state the width, not torques."""
    old, new = spring_of(before), spring_of(after)
    if not isinstance(law, MaxwellSlip) or not law.friction or old is None or new is None:
        return law
    share = float(new.torque(old.deflection(law.friction))) / float(law.friction)
    return replace(law, stiffness=tuple(share * k for k in law.stiffness))


def loss(drive: Drive) -> float:
    """Width of wide loops at zero torque, rad, as a drive file states it; NaN without hysteresis."""
    spring, law = spring_of(drive.compliance), drive.hysteresis
    if spring is None or law is None:
        return float("nan")
    return float(loss_of(law, spring))


def not_sought(drive: Drive, shows_play: bool) -> dict[str, str]:
    """What the drive states beyond the law that is sought, each with what becomes of it.

    shows_play: whether the encoders' difference shows the play.
    """
    found: dict[str, str] = {}
    if isinstance(drive.compliance, Backlash):
        seen = "fits it better than none" if shows_play else "does not show it"
        found["backlash"] = f"{drive.compliance.gap:.3g} rad is kept as stated, and the measured deflection {seen}"
    if isinstance(spring_of(drive.compliance), HarmonicSpring):
        found["wave generator"] = "its compliance is part of the identified spring, not separate from it"
    return found
