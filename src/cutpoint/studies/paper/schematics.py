"""Figures 1 to 6 and 9, redrawn for the reading that this package takes."""

from cutpoint.reporting.page import Page, Picture
from cutpoint.studies.paper.bench import Bench
from cutpoint.studies.paper.figure_1 import figure_1
from cutpoint.studies.paper.figure_2 import figure_2
from cutpoint.studies.paper.figure_3 import figure_3
from cutpoint.studies.paper.figure_4 import figure_4
from cutpoint.studies.paper.figure_5 import figure_5
from cutpoint.studies.paper.figure_6 import figure_6
from cutpoint.studies.paper.figure_9 import figure_9

_SIDES = (
    "Two coordinates describe a joint that bends: the link's q, and the motor's θ, which is the rotor's angle divided "
    "by the ratio ℓ (the paper's κ). Every angle and torque of this report is at the joint's side, so a motor torque "
    "is the shaft's times ℓ. The deflection θ − q is positive when the motor leads."
)
_FIGURE_2 = (
    "The joint cut along its axis. The paper's text exchanges the two encoders: the wave generator is on the motor, "
    "so θ_{w} is the motor-side encoder's and θ_{c} the link-side one's. With the flexspline fixed, (1) makes the "
    "motor turn ℓ + 1 times as fast as the link; (4) has ℓ, and the simulations here follow (4) with 100."
)
_FIGURE_3 = (
    "(a) Where the drive bends. By (1) and power balance an ideal gear passes τ_{f} = ℓ τ_{w}. (b) Everything at the "
    "joint's side: the deflection of (3) is the sum of both parts. (28) adds τ_{f} to a torque that already contains "
    "it, and on the other side of the gear; here the motor gives ℓ τ_{m} = ℓ I_{m} d²θ/dt² + τ_{f} + friction."
)
_FIGURE_4 = (
    "The three bodies that virtual decomposition makes of a joint, their frames (y points to the reader), and the "
    "cutting points where the joint is separated from its links. (56) keeps of the rotor's motion only its spin."
)
_FIGURE_5 = (
    "The free bodies with the forces of (9)–(11). Each red arrow stands for a force and a moment, six numbers; every "
    "force between two bodies appears twice, with opposite signs. The first force of (11) acts on the joint base, "
    "where the text says output link."
)
_FIGURE_6 = (
    "The arm to scale, from the poses (34)–(36); a square of the floor is 0.25 m wide. The rotations are those of "
    "each joint on the link before, where the paper heads them as from the world. {B₃} and {B₄} share the elbow, {B₅} "
    "and {B₆} the wrist. At q = 0 the Jacobian has rank 4, so (39) does not exist there; joint velocities are primary "
    "here. Centroids are those of Table 1 but for link 6, at +0.25 m."
)
_FIGURE_9 = (
    "The loop of section IV.B with its sides. The feedforward gives a torque and, on its elastic rung, what the motor "
    "has to track: q_{d} plus the deflection under the torque to come. The paper leaves open on which side the PD "
    "acts; ours acts on the motor's."
)


def page(bench: Bench) -> Page:
    blocks = (
        _SIDES,
        Picture("Figure 1", "Joint flexibility: where it comes from, and what it does.", figure_1()),
        Picture("Figure 2", _FIGURE_2, figure_2()),
        Picture("Figure 3", _FIGURE_3, figure_3()),
        Picture("Figure 4", _FIGURE_4, figure_4()),
        Picture("Figure 5", _FIGURE_5, figure_5()),
        Picture("Figure 6", _FIGURE_6, figure_6()),
        Picture("Figure 9", _FIGURE_9, figure_9()),
    )
    return Page("joint", "The joint and the arm", blocks)
