"""A closed loop with real encoders, and what each rung of feedforward gains."""

import numpy as np

import cutpoint
from cutpoint.control import PD, Feedforward

robot = cutpoint.robots.xia2019()
reference = cutpoint.trajectories.cycloid(end=np.radians([90, 60, 60, 90, 60, 90]), duration=2.0)
encoders = cutpoint.Sensors(
    motor_resolution=2 * np.pi / 2**13 / 100,  # 13 bits a motor turn, seen from the joint
    link_resolution=2 * np.pi / 2**19,
    speeds="differenced",
)
pd = PD(kp=[2000, 2000, 1000, 500, 300, 200], kd=[60, 60, 35, 20, 12, 10], side="motor")

for rung in ("gravity", "rigid", "friction", "elastic"):
    log = cutpoint.simulate(robot, pd + Feedforward(robot, rung), reference, sensors=encoders)
    print(f"{rung:10s} RMS error, degrees:", np.degrees(log.rms("position_error")).round(4))

log.save("run.npz")
log.plot("position_error", "motor_position_error").savefig("errors.png")
