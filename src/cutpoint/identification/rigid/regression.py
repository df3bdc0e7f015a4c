"""Torques as a linear function of the unknowns: inertias, rotors, friction and offsets of all joints.

torque = Y(q, v, a) p + I_m w_dot + sum of phi_k(v) c_k + offset, every term through one window (see `decimation`).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.identification.conditioning.decimation import Decimation
from cutpoint.identification.conditioning.motion import Motion, sliding_speeds
from cutpoint.identification.rigid.base_parameters import BaseParameters
from cutpoint.identification.triangle import CHUNK, lengths, triangle
from cutpoint.mechanics.drives.friction import Sliding

UNSEEN = 1e-9
"""Share of the largest singular value of unit-length columns: directions below it are not excited at all."""


@dataclass(frozen=True, eq=False)
class Regression:
    """torque (M, n) = columns (M, n, c) @ parameters (c,) + residuals, at times (M,), s.

    M is the number of samples after decimation: 8 M n c bytes, 30 MB for 100 s of a seven-joint arm.
    """

    names: tuple[str, ...]
    columns: Array
    torque: Array
    times: Array

    @cached_property
    def factors(self) -> Array:
        """QR triangles (n, c + 1, c + 1) of each joint's [columns, torque], sufficient for least squares."""
        rows = self.rows
        return np.array([triangle(rows[:, j]) for j in range(rows.shape[1])])

    @property
    def rows(self) -> Array:
        """[columns, torque], (M, n, c + 1)."""
        return np.concatenate([self.columns, self.torque[..., None]], axis=2)

    def residuals(self, values: Array) -> Array:
        """(M, n): residual torques of parameters (c,)."""
        return self.torque - self.columns @ values

    def with_columns(self, further: Array) -> "Regression":
        """With further columns (M, n, k), which have no names of their own."""
        names = (*self.names, *(f"further.{k}" for k in range(further.shape[2])))
        return Regression(names, np.concatenate([self.columns, further], axis=2), self.torque, self.times)

    def part(self, rows: NDArray[np.bool_ | np.intp] | slice) -> "Regression":
        """Some of the times."""
        return Regression(self.names, self.columns[rows], self.torque[rows], self.times[rows])


def regression(
    base: BaseParameters,
    laws: Mapping[str, Sliding],
    motion: Motion,
    torque: Array,
    means: Decimation,
    *,
    offsets: bool = True,
    loads: Array | None = None,
    inertial: Array | None = None,
) -> Regression:
    """The regression of a motion and torques (N, n): base parameters, each joint's friction, then offsets, by name.

    laws: a friction law for each joint, whose own coefficients do not matter.  loads: (N, n) N m that the drives
    transmit, for load-dependent laws.  inertial: those of `inertial_columns`, if known already.
    """
    inertial = inertial_columns(base, motion, means) if inertial is None else inertial
    joints, speeds = base.robot.joints, sliding_speeds(base.robot, motion)
    names, friction = [*base.names], []
    for j, joint in enumerate(joints):
        own, columns = friction_columns(laws[joint], speeds[:, j], None if loads is None else loads[:, j])
        names += [f"{name}.{joint}" for name in own]
        friction.append(of_joint(means(columns), j, len(joints)))
    # also beside dry friction that differs by direction, which equals an offset except at rest: without it, rest alone
    # would determine a joint's gravity torque where that is constant
    for j, joint in enumerate(joints if offsets else ()):
        names.append(f"offset.{joint}")
        friction.append(of_joint(np.ones((means.size, 1)), j, len(joints)))
    columns = np.concatenate([inertial, *friction], axis=2)
    return Regression(tuple(names), _told_by_links(base, columns, motion, means), means(torque), means.times)


def _told_by_links(base: BaseParameters, columns: Array, motion: Motion, means: Decimation) -> Array:
    """The columns (M, n, c) without directions that vanish where motors move with their links.

    A slide along gravity has one: its weight and an offset are both constant, and its rotor is as heavy as its link.
    Only how the spring winds tells them apart, which is less than the encoders' noise and taken for far more.
    """
    alike, sliding = columns.copy(), base.robot.mechanism.sliding
    for k, j in _rotor_columns(base):
        if base.robot.joints[j] in sliding:
            alike[:, j, k] = means(motion.a[:, [j]])[:, 0]
    if np.array_equal(alike, columns, equal_nan=True):
        return columns
    R = triangle(alike.reshape(-1, alike.shape[2]))
    length = lengths(R)
    _, s, Vt = np.linalg.svd(R / length)
    lost = Vt[s <= UNSEEN * s[0]].T
    return columns - (columns / length @ lost) @ (lost.T * length)


def _rotor_columns(base: BaseParameters) -> Iterator[tuple[int, int]]:
    """Indices of the columns that are rotors, and of their joints."""
    bodies = 10 * len(base.robot.mechanism.bodies)
    rotors = base.independent[base.independent >= bodies] - bodies
    yield from enumerate((base.rotors[k] for k in rotors), start=base.independent.size - rotors.size)


def inertial_columns(base: BaseParameters, motion: Motion, means: Decimation) -> Array:
    """(M, n, b): columns of the base parameters, with the motors' own acceleration at their rotors.

    A rotor that is lumped with its link, as the first joint's is, is assumed to move with it.
    """
    bodies, n = 10 * len(base.robot.mechanism.bodies), len(base.robot.joints)
    links = base.independent[base.independent < bodies]
    found = np.empty((means.size, n, base.independent.size))
    for rows in _chunks(means):
        samples = means.samples(rows)
        Y = base.robot.regressor(*(np.nan_to_num(x[samples]) for x in (motion.q, motion.v, motion.a)))
        found[rows, :, : links.size] = means(Y[..., links], rows)
    w_dot = means(motion.w_dot)
    for k, j in _rotor_columns(base):
        found[:, :, k] = of_joint(w_dot[:, [j]], j, n)[..., 0]
    return found


def friction_columns(law: Sliding, speed: Array, load: Array | None = None) -> tuple[list[str], Array]:
    """Names of a law's coefficients, and their columns (N, k) at a joint's speed (N,) and load (N,)."""
    names, columns = [*law.coefficients], [np.asarray(x) for x in law.columns(speed)]
    if law.per_load is not None and load is not None:
        of_one = replace(cast(Any, law), per_load=1.0)
        names, columns = [*names, "per_load"], [*columns, np.abs(load) * of_one.share_of_load(speed)]
    return names, np.column_stack(columns)


def other_side_columns(laws: Mapping[str, Sliding], motion: Motion, means: Decimation) -> Array:
    """(M, n, k): change due to the same friction on the other side of the drives; none if only one side is known.

    Motors reverse before their links do, which looks like early torques.
    """
    n = motion.v.shape[1]
    if np.array_equal(motion.v, motion.w, equal_nan=True):
        return np.zeros((means.size, n, 0))
    sides = ([friction_columns(law, x[:, j])[1] for j, law in enumerate(laws.values())] for x in (motion.w, motion.v))
    return np.concatenate([of_joint(means(w - v), j, n) for j, (w, v) in enumerate(zip(*sides, strict=True))], axis=2)


def reduced(rows: Array) -> tuple[Array, Array]:
    """R (c, c), z (c,): R x = z has the least squares of rows (..., c + 1) of [columns, torque]."""
    both = triangle(rows.reshape(-1, rows.shape[-1]))
    return both[:-1, :-1], both[:-1, -1]


def of_joint(columns: Array, joint: int, joints: int) -> Array:
    """Columns (M, k) of one joint as columns of all joints' torques, (M, n, k)."""
    found = np.zeros((columns.shape[0], joints, columns.shape[1]))
    found[:, joint] = columns
    return found


def _chunks(means: Decimation) -> Sequence[slice]:
    """Rows whose windows span about CHUNK samples each."""
    span = means.starts - means.starts[0]
    edges = np.searchsorted(span, np.arange(0, span[-1] + 1, CHUNK))
    edges = np.unique(np.append(edges, means.size))
    return [slice(a, b) for a, b in pairwise(edges.tolist())]
