"""What the study says of the claims that the paper makes for its method, its own numbers inserted."""

from collections.abc import Mapping

from cutpoint.reporting.page import number
from cutpoint.studies.cost.contenders import EXPLICIT, JETS, LAGRANGE, NE, VD, Contender
from cutpoint.studies.cost.growth import polynomial
from cutpoint.studies.cost.measure import ARM, Cost

_PERCENT = 1e4
"""A hundredth of a control period of 1 ms, ns."""


def verdict(costs: Mapping[str, Cost]) -> tuple[str, ...]:
    return (_linear(costs), _quartic(costs), _real_time(costs), _elastic(costs))


def _linear(costs: Mapping[str, Cost]) -> str:
    vd, ne = (_a_joint(costs[c.key]) for c in (VD, NE))
    return (
        "The paper says that the computation of virtual decomposition grows with the number of subsystems only. That "
        f"is true: each further joint takes {vd} more operations here, wherever the chain ends. It is equally true of "
        f"Newton-Euler as Luh, Walker and Paul wrote it in 1980, at {ne}. At six joints virtual decomposition takes "
        f"{_ratio(costs, VD, NE)} of Newton-Euler's operations and {_time_ratio(costs, VD, NE)} of its time. A "
        "difference of that size is one of arrangement: both compute the same sums, and either can borrow the other's."
    )


def _quartic(costs: Mapping[str, Cost]) -> str:
    return (
        "The fourth power that the paper sets it against is that of Lagrange's equations as Uicker and Kahn wrote "
        f"them: at six joints {_ratio(costs, LAGRANGE, VD)} times the operations and "
        f"{_time_ratio(costs, LAGRANGE, VD)} times the time of virtual decomposition. It belongs to that way of "
        "writing and not to Lagrange: Christoffel symbols from the mass matrix take the third power, and Hollerbach "
        "(1980) made Lagrange's equations recursive and linear."
    )


def _real_time(costs: Mapping[str, Cost]) -> str:
    slowest = costs[LAGRANGE.key].single[ARM].median
    return (
        "That Newton-Euler and Lagrange cannot be computed in real time is not true. The dearest of them takes "
        f"{number(slowest / 1e3, 1)} µs for six joints in a call from Python, {number(slowest / _PERCENT, 2)} % of a "
        "control period of 1 ms. What virtual decomposition does offer is that a changed drive or link changes the "
        "equations of its own subsystem only; this study does not measure that."
    )


def _elastic(costs: Mapping[str, Cost]) -> str:
    return (
        "Joints that bend take the torques' first two derivatives. Newton-Euler with every vector's derivatives "
        "written out, after Buondonno and De Luca, and virtual decomposition run on time jets are both linear: at six "
        f"joints {_ratio(costs, EXPLICIT, VD)} and {_ratio(costs, JETS, VD)} times the operations of virtual "
        "decomposition with rigid joints. That is for rotors felt by their own spin only; with full coupling the "
        "derivatives needed grow with the number of joints, and with them what each joint costs."
    )


def _a_joint(cost: Cost) -> str:
    """Operations per additional joint."""
    coefficients = polynomial(cost.operations)
    return "an unknown number" if coefficients is None else number(coefficients[-2], 0)


def _ratio(costs: Mapping[str, Cost], one: Contender, other: Contender) -> str:
    return number(costs[one.key].operations[ARM] / costs[other.key].operations[ARM], 2)


def _time_ratio(costs: Mapping[str, Cost], one: Contender, other: Contender) -> str:
    return number(costs[one.key].batched[ARM].least / costs[other.key].batched[ARM].least, 2)
