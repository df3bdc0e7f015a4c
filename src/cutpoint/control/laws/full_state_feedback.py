"""Passivity-based feedback of motor position and joint torque.  Albu-Schaeffer, Ott and Hirzinger (2007)."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from cutpoint.control.interface import SENSED, Command, Measurement, Reference
from cutpoint.control.laws.feedforward import Feedforward
from cutpoint.control.laws.model_law import ModelLaw
from cutpoint.errors import InputError
from cutpoint.mechanics.drives.harmonic_drive import DriveState, spring_torque_and_rate
from cutpoint.mechanics.elastic_forward import drive_states
from cutpoint.model.drive import Drive
from cutpoint.scalars import Scalar


@dataclass(frozen=True, eq=False)
class FullStateFeedback(ModelLaw):
    """Motor-side PD with joint torque feedback, which reduces the apparent rotor inertia, plus elastic feedforward.

    Albu-Schaeffer, Ott and Hirzinger (2007) eqs. (8)-(11): torque feedback gives the rotor the inertia
    `shaping` * J as seen by the PD, so that kp (N m/rad) and kd (N m s/rad) act through less inertia on
    the link.  The spring's torque and its rate come from the encoders on both sides.
    shaping: remaining share of the rotor's inertia, above 0 and at most 1; 1 is a plain PD, which rigid drives always
    get.
    lead: s, by which the torque is extrapolated with its rate; about a control period keeps the sample-and-hold from
    exciting undamped springs.
    For a constant reference the closed loop is passive at the links' port, whatever the environment.
    """

    kp: Any
    kd: Any
    shaping: Any = 0.5
    lead: Any = 0.0

    makes_motor_reference = True
    needs = SENSED

    def __post_init__(self) -> None:
        super().__post_init__()
        self._keep_gains("kp", "kd", "shaping", "lead", size=self.size, positive=("shaping",))
        if self.shaping.dtype != object and (self.shaping > 1).any():
            raise InputError(f"FullStateFeedback: shaping {self.shaping} must be at most 1: it makes rotors lighter")

    def start(self) -> Any:
        return self._feedforward.start()

    def step(self, memory: Any, measurement: Measurement, reference: Reference) -> tuple[Any, Command]:
        memory, wanted = self._feedforward.step(memory, measurement, reference)
        m, r = measurement, reference
        feedback = self.kp * (wanted.theta - m.theta) + self.kd * (wanted.theta_dot - m.theta_dot)
        drives = self.model.drives
        now = drive_states(drives, m.q, m.v, m.theta, m.theta_dot)
        then = drive_states(drives, r.q, r.v, wanted.theta, wanted.theta_dot)
        # excess of the spring's torque over the desired one
        each = zip(drives, now, then, self.lead, strict=True)
        excess = [_led(d.drive, at, lead) - _led(d.drive, wish, lead) for d, at, wish, lead in each]
        # the feedback is scaled by 1 / share, since the true rotor has that many times the shaped inertia
        share = self._share
        torque = wanted.torque + feedback / share + (1 - 1 / share) * np.array(excess)
        return memory, Command(torque, wanted.feedforward, wanted.theta, wanted.theta_dot)

    @property
    def _share(self) -> Any:
        """The remaining share of each rotor's inertia, (n,); 1 for rigid drives, whose rotors move with their links."""
        pairs = zip(self.model.drives, self.shaping, strict=True)
        return np.array([share if d.drive.is_elastic else 1.0 for d, share in pairs])

    @property
    def _feedforward(self) -> Feedforward:
        return Feedforward(self.robot, parameters=self.parameters)


def _led(drive: Drive, at: DriveState, lead: Scalar) -> Scalar:
    """A spring's torque plus `lead` times its rate, N m."""
    if drive.compliance is None:
        return 0
    tau_f = spring_torque_and_rate(drive, at)
    return tau_f.derivative(0) + lead * tau_f.derivative(1)
