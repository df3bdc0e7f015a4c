"""Symmetric positive definite equations on scalars of any kind, by factors that keep a tree's zeros.

Featherstone (2008) section 6.5.
"""

from collections.abc import Sequence
from typing import NamedTuple

from cutpoint.scalars import Scalar

Scalars = Sequence[Scalar]


class Factors(NamedTuple):
    """L^T D L of a symmetric positive definite matrix, from its last row up; the sparsity of a tree is preserved.

    L: its rows, of which only the part left of the diagonal counts.  inverse: of D, since a division costs as much
    as ten products.
    """

    L: list[list[Scalar]]
    inverse: list[Scalar]


def factors_of(M: list[list[Scalar]]) -> Factors:
    """Featherstone (2008) section 6.5."""
    n, L = len(M), [[*row] for row in M]
    inverse: list[Scalar] = [0] * n
    for k in reversed(range(n)):
        inverse[k] = 1 / L[k][k]
        for i in reversed(range(k)):
            share = L[k][i] * inverse[k]
            for j in range(i + 1):
                L[i][j] = L[i][j] - share * L[k][j]
            L[k][i] = share
    return Factors(L, inverse)


def solve(factors: Factors, b: Scalars) -> list[Scalar]:
    """x with M x = b, through L^T, D and L in turn.  Featherstone (2008) section 6.5."""
    (L, inverse), n, x = factors, len(b), [*b]
    for k in reversed(range(n)):
        for i in reversed(range(k)):
            x[i] = x[i] - L[k][i] * x[k]
    for k in range(n):
        x[k] = x[k] * inverse[k] - sum((L[k][i] * x[i] for i in range(k)), 0)
    return x
