"""The public face: a change to it must be meant, so it shows here."""

import re
from pathlib import Path

import public_face
from cutpoint import Robot

OFFERED = sorted(name for name in vars(Robot) if not name.startswith("_"))


def test_what_users_may_call_is_as_written_down():
    """A change that is meant is written down by tests/public_face.py."""
    assert public_face.text().splitlines() == public_face.FILE.read_text(encoding="utf-8").splitlines()


def test_the_guide_knows_all_that_a_robot_offers():
    guide = (Path(__file__).parents[1] / "docs/guide.md").read_text("utf-8")
    assert not [name for name in OFFERED if not re.search(rf"\b{name}\b", guide)]


def test_everything_public_says_what_it_is():
    assert not [name for name in OFFERED if not getattr(Robot, name).__doc__]
