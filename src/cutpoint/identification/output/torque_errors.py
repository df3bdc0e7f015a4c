"""Measured against modelled motor torques, over the fitted and the held-out part of a log."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cutpoint.arrays import Array
from cutpoint.identification.conditioning.filtering import low_pass
from cutpoint.identification.conditioning.motion import Motion, motion_of, torques_of
from cutpoint.identification.logs.recording import Recording
from cutpoint.identification.output.block_bootstrap import Ratio, error_ratio
from cutpoint.identification.output.plain_model import plain_model
from cutpoint.identification.rigid.identify_rigid import RigidEstimate, bandwidth_of
from cutpoint.identification.rigid.rigid_robot import link_torques
from cutpoint.mechanics.drives.harmonic_drive import friction_torque
from cutpoint.robot import Robot

RESTS = 0.05
"""Share of the RMS speed on the fitted part: a slower joint may stick."""


@dataclass(frozen=True, eq=False)
class TorqueErrors:
    """Motor torques, each (N, n), N m at the joint, all through one filter; NaN where anything is unknown.

    measured: as recorded.  before, after: by the robot's files and by the identified model, for the motion q, v.
    plain: by plain least squares, see `plain_model`.  load: of the links, as identified.
    held_out: (N,), samples that were not fitted.
    bandwidth: Hz, of the torques.
    """

    time: Array
    measured: Array
    before: Array
    after: Array
    plain: Array
    q: Array
    v: Array
    load: Array
    held_out: NDArray[np.bool_]
    bandwidth: float

    def rms(self, model: str, held_out: bool = False) -> Array:
        """(n,) N m: error of the model "before", "after" or "plain"; NaN where nothing was held out."""
        return self._rms(self.measured - getattr(self, model), held_out)

    def to_plain(self) -> tuple[Ratio, ...]:
        """For each joint, on the held-out part: RMS error of "after" over that of "plain", and its interval."""
        errors = [(self.measured - model)[self.held_out] for model in (self.after, self.plain)]
        known = np.isfinite(np.hstack(errors)).all(axis=1)
        # higher frequencies were filtered out: closer samples carry the same information
        width = max(1, round(0.5 / (self.bandwidth * float(np.median(np.diff(self.time))))))
        first, second = (_thinned(error[known] ** 2, width) for error in errors)
        return tuple(error_ratio(a, b) for a, b in zip(first.T, second.T, strict=True))

    def size(self) -> Array:
        """(n,) N m: RMS of the measured torques about their mean, on the fitted part."""
        return self._rms(self.measured - mean_known(self.measured[~self.held_out]), False)

    def likeness(self) -> Array:
        """(n, n) correlation of each joint's measured torques (rows) with those of each by the robot's files, on the
        fitted part: 1 same sign, -1 opposite, 0 if either is constant."""
        known = ~self.held_out & np.isfinite(self.measured + self.before).all(axis=1)
        x, y = (each[known] - each[known].sum(axis=0) / max(known.sum(), 1) for each in (self.measured, self.before))
        sizes = np.outer(np.linalg.norm(x, axis=0), np.linalg.norm(y, axis=0))
        return x.T @ y / np.where(sizes > 0.0, sizes, 1.0)

    def speed(self, held_out: bool = False) -> Array:
        """(n,) rad/s: RMS."""
        return self._rms(self.v, held_out)

    def resting(self) -> tuple[Array, Array]:
        """Shares (n,) of the held-out part while each joint rests: of time, and of the squared error of "after"."""
        held, squares = self.held_out, np.square(self.measured - self.after)[self.held_out]
        rests = np.abs(self.v[held]) < RESTS * self.speed()
        return rests.sum(axis=0) / max(held.sum(), 1), _share(np.where(rests, squares, 0.0), squares)

    def drift(self) -> Array:
        """(n,) N m: increase of each joint's dry friction from the first to the last third of the log, from errors of
        "after" while it moves."""
        ways = np.where(np.abs(self.v) < RESTS * self.speed(), 0.0, np.sign(self.v))
        along, third = (self.measured - self.after) * ways, len(self.time) // 3
        first, last = (_share(along[rows], np.abs(ways[rows])) for rows in (slice(third), slice(-third, None)))
        return last - first

    def bias(self) -> Array:
        """(n,) N m: mean of what torques exceed "after" by, on the held-out part."""
        return mean_known((self.measured - self.after)[self.held_out])

    def burst(self) -> tuple[Array, Array]:
        """(n,) s, by joint: start and length of the shortest time that holds half of the squared error of "after", on
        the fitted part, in errors while it moves; NaN where there is none."""
        fitted = ~self.held_out
        time, squares = self.time[fitted], np.nan_to_num(np.square(self.measured - self.after)[fitted])
        moves = np.abs(self.v[fitted]) >= RESTS * self.speed()
        columns = zip(np.where(moves, squares, 0.0).T, squares.sum(axis=0).tolist(), strict=True)
        found = [_half_within(time, *each) for each in columns]
        start, length = np.array(found).reshape(-1, 2).T
        return start, length

    def _rms(self, values: Array, held_out: bool) -> Array:
        return np.sqrt(mean_known(np.square(values[self.held_out == held_out])))


def mean_known(values: Array) -> Array:
    """Mean over rows (N, n) without unknown values, (n,); NaN where there are no others."""
    known = np.isfinite(values).sum(axis=0)
    return np.nansum(values, axis=0) / np.where(known, known, np.nan)


def torque_errors(
    robot: Robot,
    rigid: RigidEstimate,
    recording: Recording,
    held_from: float,
    constants: Mapping[str, float] | None,
    bandwidth: float | None,
) -> TorqueErrors:
    """Torques before and after, along a whole recording; samples from `held_from` s on count as held out.

    All are filtered as in the fit, or the models would differ by their filters.
    """
    motion = motion_of(robot, recording, rigid.cutoff)
    width = bandwidth_of(motion, bandwidth)
    recorded, held = torques_of(robot, recording, constants), recording.time >= held_from
    torques = (
        recorded,
        stated_torque(robot, motion),
        rigid.model.torque(robot, motion),
        plain_model(robot, motion, recorded, ~held, width).torque(robot, motion),
        link_torques(robot, motion, rigid.model.inertial),
    )
    measured, before, after, plain, load = (low_pass(x, motion.period, width) for x in torques)
    return TorqueErrors(recording.time, measured, before, after, plain, motion.q, motion.v, load, held, width)


def _share(part: Array, whole: Array) -> Array:
    """Ratio of sums over rows, without unknown values; 0 if there are none."""
    total = np.nansum(whole, axis=0)
    return np.nansum(part, axis=0) / np.where(total > 0.0, total, 1.0)


def _half_within(time: Array, squares: Array, whole: float) -> tuple[float, float]:
    """Start and length of the shortest time that holds half of the whole, of what is at the times (N,)."""
    total = np.concatenate([[0.0], np.cumsum(squares)])
    ends = np.searchsorted(total, total[:-1] + 0.5 * whole)
    first = np.flatnonzero(ends < total.size)
    if not (whole > 0.0 and first.size):
        return np.nan, np.nan
    lengths = time[ends[first] - 1] - time[first]
    k = int(np.argmin(lengths))
    return float(time[first[k]]), float(lengths[k])


def _thinned(values: Array, width: int) -> Array:
    """Means over so many rows; a remainder at the end is dropped."""
    rows = len(values) // width
    return values[: rows * width].reshape(rows, width, values.shape[1]).mean(axis=1)


def stated_torque(robot: Robot, motion: Motion) -> Array:
    """(N, n): motor torques by the robot's files, with its drives' springs taken as rigid."""
    found = link_torques(robot, motion, robot.inertial_parameters)
    for j, drive in enumerate(robot.drives.values()):
        load = found[:, j] + friction_torque(drive.link_friction, motion.v[:, j])
        found[:, j] = load + friction_torque(drive.motor_friction, motion.w[:, j], load)
        found[:, j] += float(drive.reflected_inertia) * motion.w_dot[:, j]
    return found
