"""The report of an identification: one self-contained HTML file."""

from collections.abc import Sequence

import numpy as np

from cutpoint.errors import counted
from cutpoint.identification.output.block_bootstrap import Ratio
from cutpoint.identification.output.drive_pictures import bendings, loop_picture, wave_picture
from cutpoint.identification.output.identification import Identification
from cutpoint.identification.output.numbers import Number
from cutpoint.identification.output.pictures import residual_picture, torque_picture
from cutpoint.joint_units import at_joints, either
from cutpoint.reporting.folder import versions
from cutpoint.reporting.html import Heading, html
from cutpoint.reporting.page import Block, Page, Picture, Table
from cutpoint.reporting.style import png, styled


def report(found: Identification, notes: Sequence[str]) -> str:
    """The page as HTML; notes: further ones."""
    pages = [_torques(found), _numbers(found), *_drives(found), _said(found, notes)]
    with styled():
        images = {picture.key: png(picture.figure) for page in pages for picture in page.pictures()}
    return html(_heading(found), pages, images, versions())


def _heading(found: Identification) -> Heading:
    recording, told = found.recording, sum(number.told for number in found.numbers)
    span = float(recording.time[-1] - recording.time[0])
    joints = len(found.robot.joints)
    about = f"{found.robot.name}: {counted(joints, 'joint')}, a log of {span:.4g} s, {recording.time.size} samples"
    held = f"{found.errors.held_out.mean():.0%} of the log, at its end, was held out of the fit."
    share = f"{told} of {len(found.numbers)} numbers are identified from this log. {held}"
    doubts = ("What makes the result doubtful:", *found.doubts) if found.doubts else ()
    return Heading("Identification", about, (share, *doubts))


def _torques(found: Identification) -> Page:
    errors, unit = found.errors, either(at_joints(found.robot, "N m").values())
    with styled():
        curves, left = torque_picture(errors, found.robot), residual_picture(errors, found.robot)
    width = f"all torques without content above {errors.bandwidth:.3g} Hz"
    blocks: tuple[Block, ...] = (
        Table("Table 1", f"RMS of torque errors, {unit} at the joint; {width}", ERROR_COLUMNS, error_rows(found)),
        "Plain least squares: rigid bodies, Coulomb and viscous friction and an offset, all torques weighted alike."
        " The last column is a 95 % interval of the identified model's error over theirs, by a block bootstrap over"
        " time: better or worse where it excludes one.",
        Picture("Figure 1", f"Torques of the motors; {width}. The part held out is on a grey background.", curves),
        Picture("Figure 2", "Residuals of the identified model, on the fitted part and the part held out.", left),
    )
    return Page("torques", "Torques", blocks)


ERROR_COLUMNS = (
    "joint",
    "torque itself, about its mean",
    "model as in the files",
    "identified, fitted part",
    "identified, held out",
    "plain least squares, held out",
    "identified over plain, held out",
)


def error_rows(found: Identification) -> tuple[tuple[str, ...], ...]:
    errors = found.errors
    columns = (errors.size(), errors.rms("before"), errors.rms("after"), errors.rms("after", True))
    plain, ratios = errors.rms("plain", True), map(ratio_words, errors.to_plain())
    rows = zip(found.robot.joints, ratios, *columns, plain, strict=True)
    return tuple((joint, *map(digits, values), ratio) for joint, ratio, *values in rows)


def _numbers(found: Identification) -> Page:
    heads = ("name", "unit", "the log alone", "95 % interval", "in the model", "in the files", "identified")
    rows = tuple(_row(number) for number in found.numbers)
    table = Table("Table 2", "Everything sought, in SI units at the joint's side", heads, rows)
    how = (
        "A base parameter is a combination of inertial parameters that torques determine; its name lists them."
        " The model's bodies are the physically possible ones nearest to the log and, where it tells nothing, to the"
        " files."
    )
    return Page("numbers", "Numbers", (how, table))


def _row(n: Number) -> tuple[str, ...]:
    name = n.name if not n.joint or n.joint in n.name else f"{n.name}, {n.joint}"
    told, interval = "yes" if n.told else f"no: {n.why}", f"{digits(n.low)} to {digits(n.high)}"
    return (name, n.unit, digits(n.value), interval, digits(n.used), digits(n.prior), told)


def digits(x: float) -> str:
    return f"{x:.4g}".replace("-", "−") if np.isfinite(x) else "–"


def ratio_words(ratio: Ratio) -> str:
    """The interval and its verdict, as "0.25 to 0.47: better"."""
    if np.isnan(ratio.value):
        return "–"
    verdict = "better" if ratio.is_less else "worse" if ratio.is_more else "unsure"
    return f"{ratio.low:.2f} to {ratio.high:.2f}: {verdict}"


def _drives(found: Identification) -> list[Page]:
    if found.drives is None or not found.drives.joints:
        return []
    bent = bendings(found.robot, found.rigid, found.drives, found.recording, found.errors.bandwidth)
    with styled():
        loops, waves = loop_picture(found.robot, found.drives, bent), wave_picture(found.robot, bent)
    over = "Torque on the link over deflection without kinematic error, and the spring's law (green)."
    left = (
        "What the springs do not explain of the encoders' difference, over waves per motor turn."
        " Waves of the kinematic error faster than the drive's resonance wind its spring, and appear smaller."
    )
    blocks = (Picture("Figure 3", over, loops), Picture("Figure 4", left, waves))
    return [Page("drives", "Drives", blocks)]


def _said(found: Identification, notes: Sequence[str]) -> Page:
    untold = found.untold or ("Everything sought is identified.",)
    blocks = ("What this log cannot tell:", *untold, "What was repaired, what looks wrong, and how it was done:")
    return Page("said", "What this log cannot tell, and notes", (*blocks, *found.notes, *notes))
