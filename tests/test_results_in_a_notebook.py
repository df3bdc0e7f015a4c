"""What a notebook shows of results: their sense in a few lines, not their arrays."""

import numpy as np
import pytest

import cutpoint
from cutpoint.analysis import frequency_response
from cutpoint.control import VDC, margins, tune
from cutpoint.studies.sizing import sizing
from cutpoint.trajectories import cycloid

ARM = cutpoint.robots.xia2019()
MOVE = cycloid(end=np.full(6, 0.05), duration=0.5)


@pytest.fixture(scope="module")
def log() -> cutpoint.Log:
    return cutpoint.simulate(ARM, tune(ARM, 4.0, VDC, derivatives="model"), MOVE, duration=0.05)


def test_a_run_its_log_and_its_certificate_are_a_few_lines(log: cutpoint.Log) -> None:
    assert repr(log.run) == f"Run({ARM!r}, VDC, 51 samples, with its state at the end)"
    assert repr(log.between(0.0, 0.02).run).endswith("without its state at the end)")
    told = repr(log.certificate())
    assert "subsystem" in told and len(told.splitlines()) == len(ARM.subsystems) + 2


def test_modes_and_responses_are_their_frequencies() -> None:
    modes = ARM.modes(np.ones(6))
    assert [float(line.split(" Hz")[0]) for line in repr(modes).splitlines()] == np.round(modes.frequencies, 2).tolist()
    response = frequency_response(ARM.linearize(np.ones(6)), np.geomspace(1.0, 300.0, 50), "joint2")
    peaks = ", ".join(f"{f:.4g}" for f in response.resonances)
    assert repr(response).startswith(f"FrequencyResponse('joint2', 50 frequencies from 1 to 300 Hz: resonances {peaks}")


def test_a_check_of_drives_says_what_holds_and_by_how_little() -> None:
    assert repr(sizing(ARM, MOVE)) == "Sizing('xia2019': all hold; nothing is stated)"
    weak = {"joint2": cutpoint.Drive(limits=cutpoint.model.Limits(effort=1.0))}
    assert "limits broken by joint2; least margin 0." in repr(sizing(ARM.with_drives(weak), MOVE))


def test_limits_in_force_are_the_tighter_of_joint_and_drive() -> None:
    weak = ARM.with_drives({"joint2": cutpoint.Drive(limits=cutpoint.model.Limits(effort=1.0, velocity=2.0))})
    assert [*weak.limits] == [*ARM.joints]
    assert (weak.limits["joint2"].effort, weak.limits["joint2"].velocity) == (1.0, 2.0)
    assert ARM.limits["joint2"].effort == np.inf


def test_margins_are_a_line_for_each_joint() -> None:
    found = margins(ARM, tune(ARM, 4.0), np.zeros(6), 1e-3)
    head, *rows = repr(found).splitlines()
    assert head.split()[0] == "joint" and "delay, ms" in head
    numbers = np.array([[float(x) for x in row.split()[1:]] for row in rows])
    np.testing.assert_allclose(numbers, np.array(found[:5]).T * [1, 1, 1, 1e3, 1], rtol=5e-3)
