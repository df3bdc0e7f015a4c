"""Sums of sines of the rotor's angle: kinematic error, torque ripple, cogging."""

from collections.abc import Sequence

from cutpoint.model.drive import Harmonic
from cutpoint.scalars import Scalar, cos, sin


def series(harmonics: Sequence[Harmonic], angle: Scalar) -> Scalar:
    """sum of amplitude sin(order angle + phase), in the amplitudes' unit."""
    parts = [h.amplitude * sin(h.order * angle + h.phase) for h in harmonics]
    return sum(parts[1:], parts[0])


def series_slope(harmonics: Sequence[Harmonic], angle: Scalar) -> Scalar:
    """d series / d angle."""
    parts = [(h.order * h.amplitude) * cos(h.order * angle + h.phase) for h in harmonics]
    return sum(parts[1:], parts[0])
