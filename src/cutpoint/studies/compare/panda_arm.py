"""Franka's arm from the package example-robot-data, with gears of the catalogue for drives."""

from dataclasses import replace
from importlib.metadata import PackageNotFoundError, files

from cutpoint.arrays import Array
from cutpoint.errors import InputError
from cutpoint.formats.catalogue.catalogue import catalogue_drive
from cutpoint.loading import load
from cutpoint.model.drive import Drive
from cutpoint.robot import Robot
from cutpoint.studies.compare.bench import gears_for

FILE = "panda_description/urdf/panda.urdf"
FINGERS = {"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0}


def panda() -> Robot:
    """The arm, fingers shut, each joint on the smallest gear that may repeat its effort limit.

    Springs, friction and the wave generators' inertia are the catalogue's; nothing else of a drive is there.

    Raises:
        InputError: example-robot-data is not installed.
    """
    try:
        found = [file for file in files("example-robot-data") or () if str(file).endswith(FILE)]
    except PackageNotFoundError:
        found = []
    if not found:
        raise InputError("panda: the package example-robot-data is not installed; pip install example-robot-data")
    arm = load(str(found[0].locate()), lock=FINGERS)
    home: Array = arm.neutral()
    gears = gears_for(arm, home, home)
    drives = {name: _plain(gear) for name, gear in zip(arm.joints, gears, strict=True)}
    return arm.with_drives(drives)


def _plain(gear: str) -> Drive:
    return replace(catalogue_drive(gear), hysteresis=None, kinematic_error=None, motor=None)
