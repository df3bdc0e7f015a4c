"""The state at the end of a log, from which another run goes on."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cutpoint import ElastoPlastic, InputError, Log, MaxwellSlip, Motor, State, Stribeck, simulate, simulate_many
from robot_library import robot

BRISTLES = ElastoPlastic(Stribeck(0.5, 0.8, 0.2, 0.1, 0.02), 1e-3, 5.0, 0.7)
PARTS: dict[str, Any] = {
    "link_friction": None,
    "motor_friction": BRISTLES,
    "hysteresis": MaxwellSlip((400.0, 300.0), (1e-4, 3e-4)),
    "motor": Motor(0.1, bandwidth=200.0),
}
START = State(q=np.full(6, 0.1))


def law(memory: Any, measurement: Any, reference: Any) -> Any:
    return memory, 300.0 * (0.3 - measurement.theta) - 10.0 * measurement.theta_dot


def test_a_run_goes_on_from_the_end_of_another():
    """Bristles, hysteresis and current loops too, as if it had not been cut, to the last bit."""
    ours = robot("xia2019")
    ours = ours.with_drives({name: replace(drive, **PARTS) for name, drive in ours.drives.items()})
    options: dict[str, Any] = {"substeps": 4}
    whole = simulate(ours, law, duration=0.2, initial=START, **options)
    (first,) = simulate_many(ours, law, duration=0.1, initial=[START], **options)
    then = simulate(ours, law, duration=0.1, initial=first.end, **options)
    for name in ("q", "theta_dot", "motor_torque", "motor_strain", "hysteresis_torque"):
        assert np.array_equal(then[name], whole[name][100:])
    assert all(np.array_equal(*pair) for pair in zip(then.end, whole.end, strict=True))


def test_a_log_without_its_whole_last_state_has_no_end(tmp_path: Path):
    log = simulate(robot("xia2019"), None, duration=0.01)
    log.save(tmp_path / "run.npz")
    few = simulate(robot("xia2019"), None, duration=0.01, channels=["q"])
    for other in (Log.load(tmp_path / "run.npz"), few, log.between(0.0, 0.005)):
        with pytest.raises(
            InputError, match="end: only a complete log of this process's own simulation, with all channels"
        ):
            _ = other.end
    assert np.array_equal(log.between(0.005, 0.01).end.q, log.end.q)
