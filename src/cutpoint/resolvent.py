"""Responses of linear models over frequency, by back substitution with a triangular form of their matrix."""

import numpy as np

from cutpoint.arrays import ComplexArray


def resolvent(T: ComplexArray, b: ComplexArray, s: ComplexArray) -> ComplexArray:
    """(s - T)^-1 b, (n, k), for an upper triangular T (n, n), b (n,) and s (k,); not finite where s is a pole.

    As of a Schur form, found once for all s.  Laub (1981) does so with a Hessenberg form.
    """
    x = np.zeros((len(b), len(s)), complex)
    with np.errstate(divide="ignore", invalid="ignore"):
        for k in reversed(range(len(x))):
            x[k] = (b[k] + T[k, k + 1 :] @ x[k + 1 :]) / (s - T[k, k])
    return x
