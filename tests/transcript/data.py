"""The numbers of section IV for the six-joint arm, SI units, in the reading that Table 3 bears out."""

import numpy as np

from transcript.appendix import Array

# Table 1, with inertias taken as isotropic about the centroid
MASSES = np.array([3.2, 3.2, 2.0, 2.0, 1.2, 1.2])
MOMENTS = np.array([0.0056, 0.0044, 0.0035, 0.0031, 0.0026, 0.0021])
CENTROIDS_AS_PRINTED = np.array(
    [[0, 0, 0.15], [0, 0, 0], [0, 0, 0], [0, 0, 0.1515], [0, 0, 0], [0, 0, -0.25]], dtype=float
)
# by (35), (36) the hand continues the forearm along +z at q_5 = 0: the printed sign folds it back,
# and the ratios of Table 3 rule it out
CENTROIDS = CENTROIDS_AS_PRINTED * np.array([1, 1, 1, 1, 1, -1.0])[:, None]

L1, L2, L3, L4 = 0.3, 0.3, 0.303, 0.5
# positions of T_1 ... T_6 in the body before, and of O in B_6:
# along z_1 to the shoulder, x_2 to the elbow, z_4 to the wrist
TRANSLATIONS = np.array([[0, 0, 0], [0, 0, L1], [L2, 0, 0], [0, 0, 0], [0, 0, L3], [0, 0, 0]])
TOOL = np.array([0, 0, L4])

# minus the acceleration of free fall, as (62) needs it
G_UP = np.array([0.0, 0.0, 9.81])

ELL = 100.0
I_M = 0.00114  # rotor inertia times ELL, after (56)

# Table 2: at the link side, f_ck at the motor side
F_C = np.array([0.49, 0.49, 0.31, 0.31, 0.1, 0.1])
F_S = np.array([3.5, 3.5, 2.8, 2.8, 0.7, 0.7])
F_V = np.array([0.15, 0.15, 0.12, 0.12, 0.03, 0.03])
V_S = np.array([0.19, 0.19, 0.15, 0.15, 0.03, 0.03])
F_CK = np.array([0.05, 0.05, 0.03, 0.03, 0.01, 0.01])

# end of the trajectory (57)
Q_D = np.deg2rad([90.0, 60.0, 60.0, 90.0, 60.0, 90.0])
T_END = 10.0

TABLE_3_MILLI: Array = np.array([0.2, 22.7, 8.9, 0.6, 2.3, 0.0])  # N mm
