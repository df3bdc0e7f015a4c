"""The classical algorithms in CasADi's symbols, written as one who wants speed from code generation would.

Inverse dynamics: Luh, Walker and Paul (1980); mass matrix and forward dynamics: Featherstone (2008) sections 6.2, 7.3.
"""

import casadi as ca
from symbolic_models import SX, Body, Chain, cross, skew


def inverse_dynamics(model: Chain, v: SX, a: SX) -> SX:
    chain, lift = model.bodies, -model.gravity
    rest, moved = (SX(3, 1), SX(3, 1), lift), []
    for i, b in enumerate(chain):
        omega, alpha, acc = moved[b.parent] if b.parent >= 0 else rest
        acc = b.R.T @ (acc + cross(alpha, b.p) + cross(omega, cross(omega, b.p)))
        carried = b.R.T @ omega
        alpha = b.R.T @ alpha + b.z * a[i] + cross(carried, b.z * v[i])
        moved.append((carried + b.z * v[i], alpha, acc))
    f = [acc * b.m + cross(dw, b.h) + cross(w, cross(w, b.h)) for b, (w, dw, acc) in zip(chain, moved, strict=True)]
    n = [b.I @ dw + cross(w, b.I @ w) + cross(b.h, acc) for b, (w, dw, acc) in zip(chain, moved, strict=True)]
    tau = [SX(0)] * len(chain)
    for i, b in reversed([*enumerate(chain)]):
        tau[i] = ca.dot(b.z, n[i])
        if b.parent >= 0:
            force = b.R @ f[i]
            f[b.parent] += force
            n[b.parent] += b.R @ n[i] + cross(b.p, force)
    return ca.vertcat(*tau)


def mass_matrix(model: Chain) -> SX:
    chain = model.bodies
    m, h, I = [b.m for b in chain], [b.h for b in chain], [b.I for b in chain]
    M = SX(len(chain), len(chain))
    for i, b in reversed([*enumerate(chain)]):
        f, n, j = cross(b.z, h[i]), I[i] @ b.z, i
        while True:
            M[i, j] = M[j, i] = ca.dot(chain[j].z, n)
            if chain[j].parent < 0:
                break
            f = chain[j].R @ f
            n, j = chain[j].R @ n + cross(chain[j].p, f), chain[j].parent
        if b.parent >= 0:
            turned, turned_I = b.R @ h[i], b.R @ I[i] @ b.R.T
            whole = turned + b.p * m[i]
            m[b.parent], h[b.parent] = m[b.parent] + m[i], h[b.parent] + whole
            I[b.parent] += symmetric(turned_I - skew(b.p) @ skew(turned) - skew(whole) @ skew(b.p))
    return ca.densify(M)


def symmetric(A: SX) -> SX:
    """The upper triangle twice, so that the lower one is not computed."""
    return ca.triu(A) + ca.triu(A, False).T


def forward_dynamics(model: Chain, v: SX, tau: SX) -> SX:
    chain, none = model.bodies, SX(6, 1)
    S = [ca.vertcat(b.z, SX(3, 1)) for b in chain]
    X = [_motion_transform(b) for b in chain]
    V, c, IA, pA = [], [], [], []
    for i, b in enumerate(chain):
        own = S[i] * v[i]
        V.append((X[i] @ V[b.parent] if b.parent >= 0 else none) + own)
        c.append(_crossed(V[i]) @ own if b.parent >= 0 else none)
        I6 = ca.blockcat([[b.I, skew(b.h)], [skew(b.h).T, SX.eye(3) * b.m]])
        IA.append(I6)
        pA.append(-_crossed(V[i]).T @ (I6 @ V[i]))
    U, D, u = [none] * len(chain), [SX(0)] * len(chain), [SX(0)] * len(chain)
    for i, b in reversed([*enumerate(chain)]):
        U[i] = IA[i] @ S[i]
        D[i], u[i] = 1 / ca.dot(S[i], U[i]), tau[i] - ca.dot(S[i], pA[i])
        if b.parent >= 0:
            felt = symmetric(IA[i] - U[i] @ U[i].T * D[i])
            bias = pA[i] + felt @ c[i] + U[i] * (u[i] * D[i])
            IA[b.parent] += symmetric(X[i].T @ felt @ X[i])
            pA[b.parent] += X[i].T @ bias
    A, acceleration = [], []
    rest = ca.vertcat(SX(3, 1), -model.gravity)
    for i, b in enumerate(chain):
        carried = X[i] @ (A[b.parent] if b.parent >= 0 else rest) + c[i]
        acceleration.append((u[i] - ca.dot(U[i], carried)) * D[i])
        A.append(carried + S[i] * acceleration[i])
    return ca.vertcat(*acceleration)


def _motion_transform(b: Body) -> SX:
    """From the parent's motion [omega; v] to this body's frame."""
    return ca.sparsify(ca.blockcat([[b.R.T, SX(3, 3)], [-b.R.T @ skew(b.p), b.R.T]]))


def _crossed(V: SX) -> SX:
    """V x on motions."""
    return ca.sparsify(ca.blockcat([[skew(V[:3]), SX(3, 3)], [skew(V[3:]), skew(V[:3])]]))
