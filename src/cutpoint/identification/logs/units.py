"""Units that logs are written in, and what their numbers are multiplied with to be SI."""

import math

ANGLES = {"rad": 1.0, "mrad": 1e-3, "deg": math.pi / 180.0, "rev": 2.0 * math.pi, "m": 1.0, "mm": 1e-3}
SPEEDS = {f"{unit}/s": factor for unit, factor in ANGLES.items()} | {"rpm": math.pi / 30.0}
TORQUES = {"N m": 1.0, "Nm": 1.0, "mN m": 1e-3, "mNm": 1e-3, "kN m": 1e3, "N": 1.0, "kN": 1e3}
CURRENTS = {"A": 1.0, "mA": 1e-3}
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}

UNITS = {"q": ANGLES, "theta": ANGLES, "v": SPEEDS, "theta_dot": SPEEDS, "torque": TORQUES, "current": CURRENTS}
"""By quantity; the first of each is SI."""

COUNTS = {"q": "counts", "theta": "counts", "v": "counts/s", "theta_dot": "counts/s"}
"""Of an encoder, by quantity: `counts_per_turn` says how many."""

WITH_GAIN = ("A", "mA", "V", "%", "1")
"""Units that only a gain makes a torque (or a current) of: a motor's current, an amplifier's command, a share."""
