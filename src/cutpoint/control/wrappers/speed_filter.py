"""Smooth speeds from encoder positions."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from cutpoint.control.interface import Command, Measurement, Reference
from cutpoint.control.law import Wrapper, as_law
from cutpoint.control.laws import command_filter
from cutpoint.door import positive
from cutpoint.kernels import Traced

DIFFERENCED = {"v": "q", "theta_dot": "theta"}
"""What each speed is found from."""


@dataclass(frozen=True, eq=False)
class SpeedFilter(Wrapper):
    """A wrapper that replaces measured speeds of links and motors by those of a critically damped tracking filter.

    z'' = w^2 (x - z) - 2 w z' with x the encoder's position, held between samples, where the step is exact; the speed
    is the difference of z over a period.  bandwidth: w / (2 pi), Hz, where the gain is one half.  Its delay, well
    below that, is 2 / w, at the default 0.8 ms.  Noise of sigma rad in each sample makes about
    sigma w^1.5 sqrt(period) / 2 rad/s as long as w is well below 1 / period; at 400 Hz and 1 kHz half of that.
    """

    law: Any
    bandwidth: Any = 400.0

    def __post_init__(self) -> None:
        self._set(law=as_law(self.law))
        if not isinstance(self.bandwidth, Traced):
            self._set(bandwidth=positive("SpeedFilter", "bandwidth", self.bandwidth, "Hz"))

    @property
    def needs(self) -> tuple[str, ...]:
        """Measurement fields that the law reads, with positions in place of speeds."""
        return tuple(dict.fromkeys(DIFFERENCED.get(name, name) for name in super().needs))

    def start(self) -> Any:
        return command_filter.start(2 * self.size), self.inner_start()

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        m, n, w = measurement, self.size, 2 * np.pi * self.bandwidth
        filters, before = command_filter.step(memory[0], [*m.q, *m.theta], w, m.period)
        # differences of z, not its rate, which sags between samples: at constant speed they are exact
        speeds = [(z - old.derivative(0)) / m.period for z, old in zip(filters.value, before, strict=True)]
        smoothed = m._replace(v=np.array(speeds[:n]), theta_dot=np.array(speeds[n:]))
        inner, command = self.inner_step(memory[1], smoothed, reference)
        return (filters, inner), command
