"""What the pure link-side PD of (58) does on an arm whose joints bend: the chattering of section II, shown."""

from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from cutpoint.reporting.page import Page, Picture, Table, number
from cutpoint.reporting.style import INK, LINK, MOTOR, WIDTH
from cutpoint.simulation import Log
from cutpoint.studies.paper.bench import Bench, pd
from cutpoint.studies.paper.printed import DURATION
from cutpoint.studies.paper.stability import fastest_growth

_SHOWN = 1  # joint 2, which has the largest load


class Loop(NamedTuple):
    """A PD loop: the encoder it reads, its gains over the bench's, whether links have friction, and what came of it."""

    side: str
    scale: float
    friction: bool
    log: Log

    @property
    def held(self) -> bool:
        """Whether it completed the run."""
        return bool(self.log.time[-1] > DURATION - 1e-6)

    @property
    def swing(self) -> float:
        """Rate of the spring that oscillates most, RMS over the second half, rad/s."""
        late = self.log.time >= self.log.time[-1] / 2
        winding = (self.log["theta_dot"] - self.log["v"])[late]
        return float(np.sqrt(np.mean(winding**2, axis=0)).max())


def page(bench: Bench) -> Page:
    loops = _loops(bench)
    blocks = (
        "(58) is written on the link's position. On a joint that bends, that closes the loop around the spring. For "
        "one joint of link inertia M, rotor inertia I and stiffness K, with link-side gains, the poles solve M I "
        "s^{4} + K (M + I) s^{2} + K K_{d} s + K K_{p} = 0. There is no s^{3}: the poles sum to zero, and with K_{d} "
        "> 0 they cannot all lie on the axis, so one of them grows, for any gains whatever. The state matrix of the "
        "whole arm has no trace either; (c) shows its fastest pole. Only what the drive loses itself, damping or "
        "friction, can hold it. On the motor's side the term K_{d} M s^{3} is there, and the loop is passive.",
        _table(loops),
        _verdict(loops),
        Picture(
            "Figure A2",
            "(a) Joint 2 under the same gains on either side, with the friction of Table 2. (b) The "
            "torque asked of its motor. (c) Without friction, damping and sampling: how fast the fastest motion of the "
            "arm at q = 0 grows (above zero) or dies (below; linear between −1 and 1).",
            _figure(bench, loops),
        ),
    )
    return Page("link-side", "The PD law (58) on the link's side", blocks, _results(loops))


def _loops(bench: Bench) -> list[Loop]:
    robots = {True: bench.robot, False: bench.frictionless}
    cases = [(1.0, True), (0.3, True), (0.1, True), (1.0, False), (0.1, False), (0.01, False)]
    link = [
        Loop("link", scale, friction, bench.run_until_it_diverges(robots[friction], pd(scale, "link")))
        for scale, friction in cases
    ]
    return [Loop("motor", 1.0, True, bench.pd_alone), *link]


def _table(loops: list[Loop]) -> Table:
    def line(loop: Loop) -> tuple[str, ...]:
        return (
            loop.side,
            f"× {loop.scale:g}",
            "Table 2" if loop.friction else "none",
            "to the end" if loop.held else f"stops at {loop.log.time[-1]:.2f} s",
            number(np.rad2deg(loop.log.rms("position_error")).max(), 2) if loop.held else "grows",
            number(loop.log.max("command_torque").max(), 0) if loop.held else "grows",
            number(loop.log.rms("feedback_torque").max(), 1) if loop.held else "grows",
            number(loop.swing, 2),
        )

    columns = (
        "side",
        "gains",
        "friction",
        "runs",
        "RMS error, worst joint [deg]",
        "peak torque [N m]",
        "RMS torque, worst joint [N m]",
        "springs swing at [rad/s], RMS, worst joint",
    )
    caption = "PD alone along (57), without feedforward and without torque limits."
    return Table("Table A1", caption, columns, tuple(line(loop) for loop in loops))


def _verdict(loops: list[Loop]) -> str:
    motor, link = loops[0], loops[1]
    return (
        "Section II speaks of a chattering effect of joint flexibility: it is shown. At the gains of Table 4 the "
        "link-side loop does not track but swings against its friction with torques of up to "
        f"{link.log.max('command_torque').max():.0f} N m, where the motor-side loop at the same gains needs "
        f"{motor.log.max('command_torque').max():.0f} N m. Lower gains swing less and sag more; without friction every "
        "one of them grows until the hardening of its springs bounds it, and the springs go on swinging at "
        f"{min(loop.swing for loop in loops if not loop.friction):.1f} rad/s and more, where the motor-side loop's "
        f"swing at {motor.swing:.2f}. An undamped elastic "
        "plant of this stiffness under pure link-side PD cannot have given Table 4: motor-side velocity, "
        "damping in the drive, or a rigid plant must have been there."
    )


def _figure(bench: Bench, loops: list[Loop]) -> Figure:
    figure = Figure(figsize=(WIDTH, 3.7), layout="constrained")
    error, torque, growth = figure.subplots(1, 3)
    for loop, colour in ((loops[1], LINK), (loops[0], MOTOR)):
        log = loop.log.between(0.0, 0.6)
        error.plot(
            log.time,
            np.rad2deg(log["position_error"][:, _SHOWN]),
            color=colour,
            lw=1.2,
            label=f"PD on the {loop.side}'s side",
        )
        torque.plot(log.time, log["command_torque"][:, _SHOWN], color=colour, lw=0.9)
    scales = np.geomspace(1e-3, 3, 60)
    growth.plot(scales, [fastest_growth(bench, "link", scale) for scale in scales], color=LINK)
    growth.plot(scales, [fastest_growth(bench, "motor", scale) for scale in scales], color=MOTOR)
    error.set(title="(a) joint 2: error [deg]", xlabel="time [s]")
    torque.set(title="(b) joint 2: torque [N m]", xlabel="time [s]")
    growth.set(title="(c) fastest growth [1/s]", xlabel="gains, times those of Table 4", xscale="log")
    growth.set_yscale("symlog", linthresh=1.0)
    growth.axhline(0.0, color=INK, lw=0.8)
    figure.legend(loc="outside lower center", ncols=2, handles=error.lines)
    return figure


def _results(loops: list[Loop]) -> dict[str, dict[str, object]]:
    units = {"position": "deg", "torque": "N m", "reached": "s", "swing": "rad/s"}
    return {"table_a1": {"units": units, "loops": [_described(loop) for loop in loops]}}


def _described(loop: Loop) -> dict[str, object]:
    """What was run and, of a loop that held, how well."""
    described: dict[str, object] = {"side": loop.side, "gain_scale": loop.scale, "friction": loop.friction}
    described |= {"reached": loop.log.time[-1], "swing": loop.swing}
    if loop.held:
        described["position_rms"] = np.rad2deg(loop.log.rms("position_error"))
        described["torque_rms"] = loop.log.rms("feedback_torque")
        described["torque_peak"] = loop.log.max("command_torque")
    return described
