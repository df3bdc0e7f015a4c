"""Machines on which drives are identified: the paper's arm, one joint, a drive whose output is locked."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import make_interp_spline

import cutpoint
from cutpoint.control import PD
from cutpoint.control.interface import Command
from cutpoint.identification import Recording
from cutpoint.model.build import build
from cutpoint.model.mechanism import Joint, Link
from cutpoint.trajectories import Trajectory

TURN = 2.0 * np.pi
STEP = TURN / 2**20
"""Of every encoder, rad on its own shaft."""

PERIOD = 1e-3
RATIO = 100.0


@dataclass(frozen=True, eq=False)
class Sines(Trajectory):
    """A sum of sines in every joint: q = centre + sum of amplitude sin(rate t + phase), each (waves, n)."""

    centre: np.ndarray
    amplitude: np.ndarray
    rate: np.ndarray
    phase: np.ndarray

    @property
    def size(self) -> int:
        return self.centre.size

    def _inside(self, t: np.ndarray, order: int) -> np.ndarray:
        angle = t[..., None, None] * self.rate + self.phase
        found = [(self.amplitude * self.rate**k * np.sin(angle + k * np.pi / 2)).sum(axis=-2) for k in range(order + 1)]
        found[0] = found[0] + self.centre
        return np.array(found)


@dataclass(frozen=True, eq=False)
class HeldNoise(Trajectory):
    """Random numbers, one a period, for a law that takes them for torques."""

    values: np.ndarray

    @property
    def size(self) -> int:
        return 1

    def _inside(self, t: np.ndarray, order: int) -> np.ndarray:
        found = np.zeros((order + 1, *t.shape, 1))
        found[0] = self.values[np.round(t / PERIOD).astype(int).clip(0, self.values.size - 1)][..., None]
        return found


def excitation(duration: float, seed: int = 3, speed: float = 1.5, joints: int = 6) -> Sines:
    """Multiples of 0.1 Hz up to 0.8 Hz, at this speed at most, rad/s; of the paper's arm, or of its first joints."""
    rng = np.random.default_rng(seed)
    rate = TURN * 0.1 * np.arange(1.0, 9.0)[:, None] * np.ones(6)
    phase = rng.uniform(0.0, TURN, rate.shape)
    plain = Sines(10.0, np.zeros(6), rng.uniform(0.5, 1.0, rate.shape) / rate, rate, phase)
    fastest = np.abs(plain.derivatives(np.linspace(0.0, 10.0, 1001), 1)[1]).max(axis=0)
    centre = np.array([0.0, 0.4, 0.6, 0.0, 0.5, 0.0])
    waves = (plain.amplitude * speed / fastest, rate, phase)
    return Sines(duration, centre[:joints], *(x[:, :joints] for x in waves))


def true_arm(hysteresis: bool) -> cutpoint.Robot:
    """The paper's arm with motor friction damped springs, kinematic errors, and hysteresis if wanted."""
    robot = cutpoint.robots.xia2019()
    drives = {}
    for k, (name, drive) in enumerate(robot.drives.items()):
        stiffness = drive.compliance.stiffness
        error = (cutpoint.Harmonic(2, 2e-4, 0.3 + k), cutpoint.Harmonic(4, 5e-5, 1.0 - k))
        drives[name] = replace(
            drive,
            kinematic_error=cutpoint.KinematicError(error),
            hysteresis=cutpoint.MaxwellSlip((0.08 * stiffness, 0.04 * stiffness), (1e-4, 3e-4)) if hysteresis else None,
            motor_friction=cutpoint.Coulomb(1.0, 0.5, 0.05),
            damping=2e-4 * stiffness,
        )
    return robot.with_drives(drives)


def supposed_arm(true: cutpoint.Robot) -> cutpoint.Robot:
    """The same links, with drives of which hardly anything is known."""
    nothing = {"kinematic_error": None, "hysteresis": None, "motor_friction": None, "damping": None}
    drives = {
        name: replace(drive, compliance=cutpoint.LinearSpring(9e3), rotor=cutpoint.Rotor(2e-5), **nothing)
        for name, drive in true.drives.items()
    }
    return true.with_drives(drives)


def measured(robot: cutpoint.Robot, duration: float, seed: int = 3, motor_step: float = STEP) -> Recording:
    """What its encoders and its controller record, each motor's encoder on the motor's shaft."""
    gains, n = ([3000.0, 3000.0, 1500.0, 400.0, 300.0, 150.0], [150.0, 150.0, 60.0, 12.0, 10.0, 5.0]), robot.nv
    sensors = cutpoint.Sensors(link_resolution=STEP, motor_resolution=motor_step / RATIO)
    law = PD(*(x[:n] for x in gains), side="motor")
    log = cutpoint.simulate(robot, law, excitation(duration, seed, joints=n), sensors=sensors)
    return Recording(
        log.time, log.joints, q=log["measured_q"], theta=log["measured_theta"], torque=log["command_torque"]
    )


def one_joint(stiffness: float) -> cutpoint.Robot:
    """A flywheel of 0.5 kg m2 behind a damped spring and a rotor of 0.2 kg m2 at the joint, some viscous friction."""
    wheel = Link("wheel", 2.0, com=np.zeros(3), inertia=0.5 * np.eye(3))
    mechanism = build("bench", [Link("base"), wheel], [Joint("axle", "continuous", "base", "wheel")])
    drive = cutpoint.Drive(
        RATIO,
        cutpoint.Rotor(2e-5),
        cutpoint.LinearSpring(stiffness),
        damping=3.0,
        link_friction=cutpoint.Coulomb(0.0, 0.5, 0.05),
        motor_friction=cutpoint.Coulomb(0.0, 1.5, 0.05),
    )
    return cutpoint.Robot(mechanism, {"axle": drive})


def pendulum() -> cutpoint.Robot:
    """A link of 12 kg that weighs on a drive of which hardly anything is known."""
    link = Link("link", 12.0, com=np.array([0.4, 0.0, 0.0]), inertia=0.3 * np.eye(3))
    axle = Joint("axle", "continuous", "base", "link", axis=np.array([0.0, 1.0, 0.0]))
    mechanism = build("bench", [Link("base"), link], [axle])
    return cutpoint.Robot(mechanism, {"axle": cutpoint.Drive(RATIO, cutpoint.Rotor(2e-5), cutpoint.LinearSpring(5e3))})


def swung(
    robot: cutpoint.Robot,
    drive: cutpoint.Drive,
    duration: float,
    late: Mapping[str, float] | None = None,
    torque_noise: float = 0.1,
) -> Recording:
    """A pendulum with that drive, a linear spring without hysteresis, along a smooth motion: every channel from the one
    before, at 8 kHz.  late: s by which channels were sampled late."""
    time = np.arange(-0.2, duration + 0.2, PERIOD / 8)
    waves = ((0.6, 0.4, 0.3), (0.12, 1.1, 1.0), (0.04, 2.3, 2.0))
    q, v, a = (
        sum(size * (TURN * f) ** k * np.sin(TURN * f * time + phase + k * np.pi / 2) for size, f, phase in waves)
        for k in range(3)
    )
    on_link = robot.inverse_dynamics(q[:, None], v[:, None], a[:, None])[:, 0]
    if drive.link_friction:
        on_link = on_link + drive.link_friction.torque(v)
    theta, share = q + drive.compliance.deflection(on_link), 1.0
    if drive.kinematic_error:
        theta = drive.kinematic_error.motor_position(theta, drive.ratio)
        share = 1.0 - drive.kinematic_error.slope(theta, drive.ratio)
    turned = make_interp_spline(time, theta, 5)
    torque = float(drive.reflected_inertia) * turned(time, 2) + share * on_link
    if drive.motor_friction:
        torque = torque + drive.motor_friction.torque(turned(time, 1), on_link)
    stamps, rng = PERIOD * np.arange(round(duration / PERIOD)), np.random.default_rng(1)

    def sampled(name: str, values: np.ndarray, step: float) -> np.ndarray:
        found = make_interp_spline(time, values, 3)(stamps - (late or {}).get(name, 0.0))
        return np.round(found / step)[:, None] * step if step else found[:, None]

    noise = torque_noise * rng.normal(size=(stamps.size, 1))
    channels = {"q": sampled("q", q, STEP), "theta": sampled("theta", theta, STEP / RATIO)}
    return Recording(stamps, ("axle",), **channels, torque=sampled("torque", torque, 0.0) + noise)


def shaken(robot: cutpoint.Robot, duration: float, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """What a motor's encoder shows, rad, under its random torques, N m."""
    noise = 6.0 * np.random.default_rng(seed).standard_normal(round(duration / PERIOD) + 1)
    sensors = cutpoint.Sensors(motor_resolution=STEP / RATIO)
    start = cutpoint.State(q=np.zeros(1), v=np.zeros(1), theta=np.zeros(1))
    log = cutpoint.simulate(
        robot,
        lambda memory, measurement, reference: (memory, Command(reference.q)),
        HeldNoise(duration, noise),
        initial=start,
        sensors=sensors,
    )
    return log["measured_theta"][:, 0], log["command_torque"][:, 0]


def wound(spring, hysteresis: cutpoint.MaxwellSlip, torque: np.ndarray) -> np.ndarray:
    """Deflections under a torque on spring and elements side by side, by bisection."""
    strains, before, found = tuple(0.0 for _ in hysteresis.reach), 0.0, []
    for target in torque.tolist():
        low, high = -0.02, 0.02
        for _ in range(40):
            middle = 0.5 * (low + high)
            total = spring.torque(middle) + hysteresis.torque(hysteresis.strains(strains, middle - before))
            low, high = (low, middle) if total > target else (middle, high)
        strains = hysteresis.strains(strains, low - before)
        before = low
        found.append(low)
    return np.array(found)
