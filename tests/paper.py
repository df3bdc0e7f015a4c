"""Every numbered equation of Xia et al. (2019), IEEE Access 7, doi 10.1109/ACCESS.2019.2919749, in plain NumPy.

An oracle: it shares no code with the package.  The functions stand in `transcript/`, one file per section, in the
paper's symbols; where the print slips, the docstring gives the corrected reading and its reason.

    EQUATIONS["(49)"].function     evaluates the right-hand side of eq. (49)
    DEFINITIONS["(10)"]            why eq. (10) has nothing to evaluate
    arm.joint_torques(q, v, a)     the six-joint arm as a whole
    data.MASSES                    the numbers of its tables
"""

from transcript import appendix, arm, data, joint, manipulator, simulation
from transcript.registry import Equation, equations_of

__all__ = [
    "DEFINITIONS", "EQUATIONS", "Equation", "appendix", "arm", "data", "joint", "manipulator", "simulation",
]  # fmt: skip

DEFINITIONS: dict[str, str] = {
    "(10)": "gives the rotor's net wrench a second name: the rotor touches nothing but the joint base",
    "(19)": "gives the rotor's required net wrench a second name, as (10) does",
    "(24)": "is (19) read from right to left",
}

EQUATIONS: dict[str, Equation] = equations_of(joint, manipulator, appendix, simulation)
