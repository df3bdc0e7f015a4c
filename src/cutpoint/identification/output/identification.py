"""The result of `identify`."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from cutpoint.identification.drives.identify_drives import DriveEstimates
from cutpoint.identification.logs.recording import Recording
from cutpoint.identification.output.numbers import Number
from cutpoint.identification.output.torque_errors import TorqueErrors
from cutpoint.identification.rigid.identify_rigid import RigidEstimate
from cutpoint.robot import Robot


@dataclass(frozen=True, eq=False, repr=False)
class Identification:
    """An identified robot.

    robot: the identified one; before: as its files state it.  source: its file, None for a robot without one.
    xacro: arguments of that file.
    rigid: links, rotors, friction.  drives: springs of the drives, None unless encoders on both sides were recorded.
    numbers: all that was sought, with intervals.  errors: of torques, before and after.  recording: as used, whole.
    untold: what this log cannot determine.  doubts: what makes the result doubtful.  causes: those of them from which
    the later ones may follow, such as swapped columns.  notes: repairs, suspicious data, and methods.
    """

    robot: Robot
    before: Robot
    source: Path | None
    xacro: Mapping[str, str]
    rigid: RigidEstimate
    drives: DriveEstimates | None
    numbers: tuple[Number, ...]
    errors: TorqueErrors
    recording: Recording = field(repr=False)
    untold: tuple[str, ...]
    doubts: tuple[str, ...]
    causes: tuple[str, ...]
    notes: tuple[str, ...]

    def __repr__(self) -> str:
        told = sum(number.told for number in self.numbers)
        return f"Identification({self.robot.name!r}: {told} of {len(self.numbers)} numbers identified)"

    def save(self, folder: str | Path, *, force: bool = False) -> list[Path]:
        """Writes robot.urdf, robot.drives.yaml, parameters.json and report.html, each atomically.

        A robot without a URDF gets robot.inertias.json instead of the first.
        Raises InputError if the folder has such files, unless `force` says to overwrite them.
        """
        from cutpoint.identification.output.saving import save

        return save(self, Path(folder), force)
