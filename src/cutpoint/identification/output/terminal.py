"""Output of an identification to a terminal."""

from rich.table import Table
from rich.text import Text

from cutpoint.errors import counted
from cutpoint.identification.output.identification import Identification
from cutpoint.identification.output.report import error_rows
from cutpoint.joint_units import at_joints, either

COLUMNS = ("joint", "torque", "files", "identified", "held out", "plain", "held out over plain", "friction")

SHOWN = 6
"""Most lines on what is undetermined."""


def table_of(found: Identification) -> Table:
    """RMS torque of each joint, and errors of the model before and after."""
    band = f"below {found.errors.bandwidth:.3g} Hz"
    unit = either(at_joints(found.robot, "N m").values())
    title = f"{found.robot.name}: RMS of torques about their mean, and of their errors, {unit} at the joint, {band}"
    table = Table(title=Text(title), title_justify="left")
    for k, column in enumerate(COLUMNS):
        table.add_column(column, justify="right" if 0 < k < 6 else "left", overflow="fold")
    laws = {choice.joint: choice.family for choice in found.rigid.friction}
    for joint, *words in error_rows(found):
        table.add_row(Text(joint), *words, laws.get(joint, "as stated"))
    told = sum(number.told for number in found.numbers)
    what = "plain: least squares with Coulomb and viscous friction, on the part held out too"
    table.caption = f"{told} of {len(found.numbers)} numbers identified from this log; {what}"
    return table


def sentences(found: Identification) -> list[str]:
    """What makes the result doubtful, what is undetermined and what was done, a line each; the report has all of it."""
    # hysteresis, which few logs determine, last
    untold = [f"not identified: {words}" for words in sorted(found.untold, key=lambda words: "hysteresis" in words)]
    if len(untold) > SHOWN:
        untold[SHOWN - 1 :] = [f"not identified: {len(untold) - SHOWN + 1} more numbers, see the report"]
    choices = {str(choice) for choice in found.rigid.friction}
    return [*_warnings(found), *untold, *(f"note: {words}" for words in found.notes if words not in choices)]


def _warnings(found: Identification) -> list[str]:
    """The doubts; of those that may follow from the last known cause, how many there are."""
    known = 1 + found.doubts.index(found.causes[-1]) if found.causes else len(found.doubts)
    shown, others = [*found.doubts[:known]], len(found.doubts) - known
    if others:
        shown += [f"{counted(others, 'further doubt')} may follow from this, see the report: correct it first"]
    return [f"warning: {words}" for words in shown]
