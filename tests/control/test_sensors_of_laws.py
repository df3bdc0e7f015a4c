"""Laws state the sensors that they need, are refused without them, and read nothing else."""

import numpy as np
import pytest
from law_library import LAWS, elbow, law

from cutpoint import InputError, Sensors, simulate
from cutpoint.control import (
    PD,
    PID,
    Command,
    ComputedTorque,
    DisturbanceObserver,
    Measurement,
    Reference,
    Robust,
    SlotineLi,
    SuperTwisting,
    margins,
    slowest_pole,
)
from cutpoint.control.law import needs_of

SENSORS = ("q", "v", "theta", "theta_dot")

READERS = {
    "motor": [
        "PD + gravity",
        "elastic computed torque",
        "full state feedback",
        "VDC, model",
        "adaptive VDC, projection",
    ],
    "link": ["PD", "PID", "computed torque", "Slotine-Li", "robust", "disturbance observer", "VDC, filter"],
}


@pytest.mark.parametrize(("sides", "name"), [(sides, name) for sides, names in READERS.items() for name in names])
def test_a_law_that_reads_a_sensor_which_is_not_there_is_refused(sides, name):
    with pytest.raises(InputError, match=rf"reads [\w, ]+, but sensors are on the {sides} side only; use "):
        simulate(elbow(), law(name), duration=0.01, sensors=Sensors(sides=sides))


def still(memory, measurement, reference):
    return memory, Command(-measurement.v)


@pytest.mark.parametrize("judge", [slowest_pole, margins])
@pytest.mark.parametrize("made", [law("VDC, model"), still])
def test_a_loop_without_the_sensors_that_it_needs_is_not_judged(judge, made):
    with pytest.raises(InputError, match=r"(slowest_pole|margins): \w+ reads .* are on the motor side only"):
        judge(elbow(), made, [0.0] * 2, 1e-3, sensors=Sensors(sides="motor"))


ONE_SIDED = {
    "PD": lambda side: PD([9.0] * 2, [1.0] * 2, side=side),
    "PID": lambda side: PID([9.0] * 2, 1.0, 1.0, 50.0, side=side),
    "computed torque": lambda side: ComputedTorque(elbow(), 9.0, 1.0, side=side),
    "Slotine-Li": lambda side: SlotineLi(elbow(), 9.0, 1.0, side=side),
    "robust": lambda side: Robust(elbow(), 9.0, 1.0, 1.0, side=side),
    "super-twisting": lambda side: SuperTwisting(elbow(), 9.0, 1.0, 1.0, 1.0, side=side),
    "observer": lambda side: DisturbanceObserver(elbow(), PD([9.0] * 2, [1.0] * 2, side=side), 1.0, side=side),
}


@pytest.mark.parametrize("side", ["motor", "link"])
@pytest.mark.parametrize("name", ONE_SIDED)
def test_a_law_of_one_side_does_with_the_sensors_of_that_side(name, side):
    log = simulate(elbow(), ONE_SIDED[name](side), duration=0.02, sensors=Sensors(sides=side))
    assert np.isfinite(log["command_torque"]).all()


def test_what_a_law_says_that_it_needs_is_all_that_it_reads():
    """NaN in a field that it does not name changes nothing."""
    rng = np.random.default_rng(9)
    q, v, e, w = 0.1 * rng.normal(size=(4, 2))
    m = Measurement(0.0, 1e-3, q, v, q + 1e-3 * e, v + w)
    r = Reference(q, *rng.normal(size=(4, 2)), q, v)
    for name in LAWS:
        made = law(name)
        blind = m._replace(**{x: np.full(2, np.nan) for x in SENSORS if x not in needs_of(made)})
        memory, found = made.start(), []
        for seen in (m, blind):
            found.append(made.step(memory, seen, r)[1].torque)
        assert np.array_equal(np.array(found[0], float), np.array(found[1], float)), name


@pytest.mark.parametrize("name", LAWS)
def test_a_measurement_that_is_not_a_number_is_never_a_torque(name):
    """A drive whose encoder fails is asked for no torque that could be mistaken for one."""
    rng, made = np.random.default_rng(10), law(name)
    r = Reference(*0.1 * rng.normal(size=(7, 2)))
    filtered = {"v", "theta_dot"} if name == "speed filter" else set()  # which finds speeds itself
    for needed in sorted({*needs_of(made)} - filtered):
        for joint in range(2):
            seen = 0.1 * rng.normal(size=(4, 2))
            seen[SENSORS.index(needed), joint] = np.nan
            torque = made.step(made.start(), Measurement(0.0, 1e-3, *seen), r)[1].torque
            assert np.isnan(np.array(torque, float)[joint]), needed
