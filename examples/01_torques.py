"""Torques of a motion: what the joints need, and what motors behind bending drives must do for it."""

import numpy as np

import cutpoint

robot = cutpoint.robots.xia2019()
reference = cutpoint.trajectories.cycloid(end=np.radians([90, 60, 60, 90, 60, 90]), duration=2.0)
times = np.linspace(0.0, reference.duration, 201)

# a whole trajectory is one call: leading axes are a batch
motion = reference(times)
rigid = robot.inverse_dynamics(motion.q, motion.v, motion.a)
elastic = robot.elastic_inverse_dynamics(*motion)

lead = np.degrees(elastic.theta - motion.q) * 60
print("peak joint torque, N m:          ", np.abs(rigid).max(axis=0).round(3))
print("peak motor torque, N m at joint: ", np.abs(elastic.motor_torque).max(axis=0).round(3))
print("peak lead of the motors, arcmin: ", np.abs(lead).max(axis=0).round(3))

# the same arm with something in its hand
loaded = robot.with_payload(mass=1.0, com=[0, 0, 0.05], inertia=np.diag([1e-3, 1e-3, 1e-3]), frame="tool")
print("gravity with 1 kg in the hand:   ", loaded.gravity_forces(motion.q[-1]).round(3))
