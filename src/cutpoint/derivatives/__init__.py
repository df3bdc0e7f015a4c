"""Derivatives of a robot's dynamics, exact to rounding, as functions compiled at their first call.

They complement `Robot`, which has the functions themselves, and are called like its methods: leading axes are batches,
and a wrong shape or a number that is not finite raises an InputError that names it.  d_q is along the tangent
directions of `Robot.integrate`, which equal q except for quaternions and planar joints.

For large robots those of rigid dynamics run as loops over bodies, and those of accelerations follow from them.  Where
loops do not support a robot of more than 24 bodies or 36 speeds, they are computed by sweeps, one configuration after
another: see `sweeps`; those of elastic inverse dynamics are refused for more than 48 bodies.
"""

from cutpoint.derivatives.functions import (
    ElasticForwardDynamicsDerivatives,
    ElasticInverseDynamicsDerivatives,
    ForwardDynamicsDerivatives,
    InverseDynamicsDerivatives,
    elastic_forward_dynamics,
    elastic_inverse_dynamics,
    forward_dynamics,
    inverse_dynamics,
)

__all__ = [
    "ElasticForwardDynamicsDerivatives", "ElasticInverseDynamicsDerivatives", "ForwardDynamicsDerivatives",
    "InverseDynamicsDerivatives", "elastic_forward_dynamics", "elastic_inverse_dynamics", "forward_dynamics",
    "inverse_dynamics",
]  # fmt: skip
