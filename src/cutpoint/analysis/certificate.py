"""The power-flow certificate of virtual decomposition control.  Zhu (2010) sections 2.9 and 2.10, chapter 3.

Every subsystem i has a storage nu_i >= 0 of the errors of its speeds, V_r - V, and of its spring's deflection.  In
continuous time, with exact state and model, nu_i' = inflow - dissipation, where flows are those of virtual power,
(V_r - V)^T (F_r - F), across its cuts; the outflow of one subsystem is the inflow of another, so their total storage
can only decrease.  For elastic joints that holds with linear undamped springs, links without friction and motor
friction independent of load: the law neglects the rates of these terms.  A log is finite and sampled as well: it shows
how far each subsystem is from the ideal.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from cutpoint import kernels
from cutpoint.analysis.virtual_power import Flows, virtual_power_flows
from cutpoint.arrays import Array
from cutpoint.control.interface import Measurement, Reference
from cutpoint.control.laws.vdc import VDC
from cutpoint.errors import InputError
from cutpoint.robot import Robot
from cutpoint.scalars import leaves, rebuild
from cutpoint.simulation.log.log import Log


@dataclass(frozen=True, eq=False, repr=False)
class Certificate:
    """Each subsystem's power-flow inequality, nu' <= inflow - dissipation, evaluated on a log.

    subsystems: names, m of them.  time: (N,), s.  storage (J), dissipation (W), inflow (W): (N, m).
    slack: (N - 1, m), W, growth of nu beyond the inequality's bound, mean over each interval; at most zero where it
    holds.  imbalance: (N,), W, sum of all inflows: power lost between subsystems.
    """

    subsystems: tuple[str, ...]
    time: Array
    storage: Array
    dissipation: Array
    inflow: Array
    slack: Array
    imbalance: Array

    @property
    def violated(self) -> dict[str, float]:
        """The largest violation of each subsystem, W."""
        worst = np.maximum(self.slack.max(axis=0), 0.0)
        return dict(zip(self.subsystems, worst.tolist(), strict=True))

    def __repr__(self) -> str:
        width = max(map(len, self.subsystems))
        lines = [f"{'subsystem':{width}}  violated, W  dissipated, W (means)"]
        mean, lost = np.maximum(self.slack, 0).mean(axis=0), self.dissipation.mean(axis=0)
        for name, worst, usual, dissipated in zip(self.subsystems, self.violated.values(), mean, lost, strict=True):
            lines.append(f"{name:{width}}  at most {worst:.2e}, mean {usual:.2e}; {dissipated:.2e}")
        between = f"between subsystems at most {np.abs(self.imbalance).max():.1e} W is lost"
        return "\n".join([*lines, f"{between}, over {len(self.time)} samples: nothing is said of other times"])


def certificate(log: Log) -> Certificate:
    """The certificate of a simulated log: see `Certificate`.

    Raises InputError for a log without its run, and for a law other than a VDC with derivatives from the model or a
    rigid one: others have memory that is not in the log.
    """
    if log.run is None:
        raise InputError("certificate: only a log simulated in this process knows its robot, law and reference")
    robot, law, reference, _ = log.run
    if type(law) is not VDC or leaves(law.start()):
        name = type(law).__name__
        found = f"{name} with derivatives={law.derivatives!r}" if type(law) is VDC else name
        raise InputError(
            f"certificate: only a VDC with derivatives='model', by itself, has one, but this run is of {found}",
            law=name,
        )
    for name, drive in robot.drives.items():
        if drive.hysteresis or drive.motor:
            found = f"the drive of {name!r} has {'hysteresis' if drive.hysteresis else 'a motor model'}"
            remedy = "simulate the robot without: dataclasses.replace(drive, hysteresis=None, motor=None)"
            raise InputError(f"certificate: {found}, which it does not cover; {remedy}", joint=name)
    seen = [log[f"measured_{name}"] for name in ("q", "v", "theta", "theta_dot")]
    actual = [log[name] for name in ("q", "v", "theta", "theta_dot", "motor_torque")]
    numbers = [np.array(x, float) for x in (robot.drive_parameters, leaves(law))]
    found = _kernel(robot, law)(*seen, *actual, *reference, *numbers)
    slack = _slack(log.time, found)
    return Certificate(
        _names(robot), log.time, found.storage, found.dissipation, found.inflow, slack, found.inflow.sum(axis=1)
    )


def _slack(time: Array, flows: Flows) -> Array:
    """Growth of storage over each interval beyond inflow less dissipation, W; by cubic quadrature."""
    allowed = CubicSpline(time, flows.inflow - flows.dissipation).antiderivative()(time)
    return np.diff(flows.storage - allowed, axis=0) / np.diff(time)[:, None]


def _names(robot: Robot) -> tuple[str, ...]:
    bodies = [f"link {segment.name}" for segment in robot.machine.system.segments]
    return (*bodies, *(f"joint {name}" for name in robot.drives))


def _kernel(robot: Robot, law: VDC) -> Any:
    n, measured = len(robot.drives), ("q", "v", "theta", "theta_dot")
    seen, held = [f"measured_{name}" for name in measured], [f"reference_{k}" for k in range(5)]

    def virtual_power(numbers: Any, gains: Any, **given: Any) -> Flows:
        m = Measurement(0, 0, *(np.array(given[name]) for name in seen))
        q, v, a, jerk, snap = (np.array(given[name]) for name in held)
        own, machine = rebuild(law, iter(gains)), robot.machine_with(numbers)
        state = [[*given[name]] for name in (*measured, "motor_torque")]
        return virtual_power_flows(machine, state, own, m, Reference(q, v, a, jerk, snap, q, v))

    sizes: dict[str, Any] = dict.fromkeys((*seen, *measured, "motor_torque", *held), n)
    sizes |= {"numbers": len(robot.drive_parameters), "gains": len(leaves(law))}
    return kernels.compile(virtual_power, backend=robot.backend, **sizes)
