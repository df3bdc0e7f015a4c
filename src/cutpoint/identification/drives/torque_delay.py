"""Delay of motors' torques relative to their time stamps, found from springs, which measure the load without delay.

Losses in a spring make the motor's load lead the measured one: that looks like a torque that acts later.
"""

from collections.abc import Collection, Mapping
from typing import NamedTuple

import numpy as np

from cutpoint.identification.drives.scatter import SIGNIFICANT

LEAST_DELAY = 2e-4
"""s: smaller delays are not reported.  In trials model errors caused 0.1 ms; 2 ms made rotors a quarter too light."""


DAMPED = 1e-3
"""s: a spring's damping over its stiffness, up to which a stated delay is not doubted."""


class Delay(NamedTuple):
    """s by which a torque acts later than its stamp, if its spring is lossless, and its standard deviation."""

    value: float
    deviation: float


def delay_notes(delays: Mapping[str, Delay], supposed: float, damped: Collection[str]) -> tuple[str, ...]:
    """A sentence if torques act later or earlier than supposed, s; by name, for joints whose springs show it.

    damped: joints whose damping is determined; without it, damping is no evidence of a delay.
    """
    if not delays:
        return ()
    values, deviations = (np.array(x) for x in zip(*delays.values(), strict=True))
    found, surely = float(np.median(values)), max(LEAST_DELAY, SIGNIFICANT * float(np.median(deviations)))
    each = ", ".join(f"{joint} {1e3 * x.value:.2f} +- {1e3 * x.deviation:.1g} ms" for joint, x in delays.items())
    remedy, taken = f"torque_delay={found:.2g}, --delay {found:.2g}", _when(supposed) if supposed else "on time"
    if found - supposed < -surely:
        words = f"springs show that torques act {_when(found)} than stamped, not {taken} ({each})"
        rule = "until then rotors and dampings come out too small; damping hides part of it: check again"
        return (f"{words}: align them with {remedy}; {rule}",)
    likely = max(surely, float(np.ptp(values)), DAMPED if supposed else 0.0)
    if len(values) > 1 and set(delays) <= set(damped) and found - supposed > likely:
        words = f"all springs seem damped by {1e3 * (found - supposed):.2g} ms of their stiffness"
        alike = "this log does not tell which; held commands act half a period late"
        return (f"{words}, or torques act {_when(found)} than stamped, not {taken}: {alike}",)
    return ()


def _when(delay: float) -> str:
    return f"{1e3 * abs(delay):.2g} ms {'earlier' if delay < 0.0 else 'later'}"
