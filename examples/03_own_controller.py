"""A controller of one's own, compiled into the loop: PD with a low-pass filter on the motors' speed."""

from dataclasses import dataclass

import numpy as np

import cutpoint


@dataclass(frozen=True)
class FilteredPD:
    """kp in N m/rad, kd in N m s/rad, bandwidth of the filter in rad/s."""

    kp: float
    kd: float
    bandwidth: float

    def start(self) -> np.ndarray:
        return np.zeros(6)

    def step(self, speed, measured, reference):
        share = self.bandwidth * measured.period
        speed = speed + share * (measured.theta_dot - speed)
        torque = self.kp * (reference.theta - measured.theta) + self.kd * (reference.theta_dot - speed)
        return speed, torque


robot = cutpoint.robots.xia2019()
reference = cutpoint.trajectories.septic(end=np.full(6, 0.5), duration=1.0)

# numbers in the fields are inputs of the compiled loop: this sweep compiles once
for bandwidth in (100.0, 300.0, 900.0):
    log = cutpoint.simulate(robot, FilteredPD(1000.0, 40.0, bandwidth), reference)
    print(f"{bandwidth:5.0f} rad/s: peak error {np.degrees(log.max('position_error')).max():.3f} degrees")
