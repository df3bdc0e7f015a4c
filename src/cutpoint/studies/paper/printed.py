"""What the paper prints in section IV, and the settings it states."""

import numpy as np

JOINTS = tuple(f"joint {k}" for k in range(1, 7))

LENGTHS = {"l_1": 0.3, "l_2": 0.3, "l_3": 0.303, "l_4": 0.5}
"""m; l_4 is from the wrist to the tool."""

GOAL = np.deg2rad([90.0, 60.0, 60.0, 90.0, 60.0, 90.0])
"""q_d of eq. (57), rad."""

DURATION = 10.0
"""T of eq. (57), s."""

TABLE_3 = (0.2, 22.7, 8.9, 0.6, 2.3, 0.0)
"""RMS of the joint torque differences, N mm; the text adds: no more than 35 N mm."""

TABLE_3_LARGEST = 35.0

TABLE_4_POSITION = (0.0334, 0.0115, 0.0396, 0.1336, 0.0080, 0.0470)
"""RMS position tracking errors, degrees; the text adds: less than 0.4 degrees."""

TABLE_4_TORQUE = (0.1197, 0.4594, 0.2381, 0.0951, 0.3947, 0.0513)
"""RMS torque compensation errors, N m."""

GOAL_5 = np.deg2rad([60.0, 30.0])
"""q_d of the experiment of section IV.C, joints 1 and 2, rad."""

DURATION_5 = 30.0
"""T of the experiment, s."""

TABLE_5_POSITION = (0.0456, 0.0227)
"""RMS position tracking errors of joints 1 and 2, degrees."""

TABLE_5_PEAK = 0.2
"""No position error is larger, degrees: the text, on figure 13."""

TABLE_5_TORQUE = (0.1173, 0.2981)
"""RMS torque compensation errors of joints 1 and 2, N m."""
