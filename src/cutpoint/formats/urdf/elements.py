"""Attributes and single children of URDF elements, read strictly: each error names thing, value, rule and line."""

import math
from dataclasses import dataclass

import numpy as np

from cutpoint.arrays import Array
from cutpoint.errors import ModelError
from cutpoint.formats.reading import parse_number
from cutpoint.formats.safe_xml import Element
from cutpoint.mechanics.bodies.rotations import rotation_of
from cutpoint.model.pose import pose, roll_pitch_yaw
from cutpoint.model.validation import DEGREES_BEYOND


def name_of(element: Element) -> str:
    """The name of a link or a joint, without surrounding blanks; empty if it has none."""
    return element.attributes.get("name", "").strip()


@dataclass(frozen=True)
class Reader:
    """One element on behalf of the link or joint it belongs to (`thing`)."""

    element: Element
    thing: str
    file: str

    def error(self, complaint: str) -> ModelError:
        return ModelError(f"{self.thing}: {complaint}", place=f"{self.file}:{self.element.line}", thing=self.thing)

    def child(self, tag: str) -> "Reader | None":
        """The one child of that tag, if there is one."""
        found = list(self.element.all(tag))
        if len(found) > 1:
            raise Reader(found[1], self.thing, self.file).error(f"has {len(found)} <{tag}>; at most one is allowed")
        return Reader(found[0], self.thing, self.file) if found else None

    def needed(self, tag: str) -> "Reader":
        found = self.child(tag)
        if found is None:
            raise self.error(f"<{self.element.tag}> needs an element <{tag}>")
        return found

    def text(self, attribute: str) -> str:
        """An attribute that must be there and not be empty, without surrounding blanks."""
        value = self.element.attributes.get(attribute, "").strip()
        if not value:
            what = "has nothing in" if attribute in self.element.attributes else "needs"
            raise self.error(f"<{self.element.tag}> {what} the attribute {attribute!r}")
        return value

    def number(self, attribute: str, default: float | None = None, rule: str = "a finite number") -> float:
        if default is not None and attribute not in self.element.attributes:
            return default
        text = self.text(attribute)
        value = parse_number(text)
        if value is None:
            raise self._not_numbers(attribute, text, rule)
        return value

    def bound(self, attribute: str, default: float) -> float:
        """A number that may also be `inf` or `-inf`: no bound."""
        text = self.element.attributes.get(attribute, "").strip().lower()
        unbounded = {"inf": math.inf, "+inf": math.inf, "-inf": -math.inf}
        return unbounded[text] if text in unbounded else self.number(attribute, default, "a number, inf or -inf")

    def vector(self, attribute: str, default: tuple[float, float, float]) -> Array:
        """(3,) numbers separated by blanks."""
        if attribute not in self.element.attributes:
            return np.array(default)
        text = self.text(attribute)
        values = [parse_number(part) for part in text.split()]
        if len(values) != 3 or None in values:
            raise self._not_numbers(attribute, text, "three finite numbers")
        return np.array(values, dtype=np.float64)

    def origin(self) -> Array:
        """(4, 4) placement of the child <origin>; the identity where there is none."""
        found = self.child("origin")
        if found is None:
            return np.eye(4)
        translation = found.vector("xyz", (0.0, 0.0, 0.0))
        if "quat_xyzw" in found.element.attributes:
            return pose(found.turned(), translation)
        angles = found.vector("rpy", (0.0, 0.0, 0.0))
        if np.max(np.abs(angles)) > DEGREES_BEYOND:
            text = found.text("rpy")
            raise found.error(f"<origin> rpy {text!r} looks like degrees; URDF angles are radians")
        return pose(roll_pitch_yaw(angles), translation)

    def turned(self) -> Array:
        """(3, 3) rotation of the quaternion x, y, z, w that files of version 1.2 may state in place of rpy."""
        if "rpy" in self.element.attributes:
            raise self.error(f"<{self.element.tag}> states both rpy and quat_xyzw; leave one out")
        text = self.text("quat_xyzw")
        quaternion = [x for part in text.split() if (x := parse_number(part)) is not None]
        if len(quaternion) != 4 or len(text.split()) != 4 or not any(quaternion):
            raise self._not_numbers("quat_xyzw", text, "four finite numbers, not all zero")
        largest = max(map(abs, quaternion))  # any length may be stated, and its square may overflow
        return np.array([[*row] for row in rotation_of([x / largest for x in quaternion])], dtype=np.float64)

    def _not_numbers(self, attribute: str, text: str, rule: str) -> ModelError:
        remedy = ""
        if "$" in text:
            remedy = "; it is for xacro to compute: give the file the ending .xacro"
        elif "," in text:
            remedy = "; use no commas: decimals have a point, and blanks separate numbers"
        return self.error(f"<{self.element.tag}> {attribute} {text[:200]!r} must be {rule}{remedy}")
