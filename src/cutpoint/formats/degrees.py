"""One warning about limits that a file states in degrees, as it seems."""

from collections.abc import Mapping

from cutpoint.callers import warn
from cutpoint.errors import listed
from cutpoint.model.limits import DegreesWarning, look_like_degrees
from cutpoint.model.mechanism import Limits


def warn_of_degrees(limits: Mapping[str, Limits], rule: str, place: str) -> None:
    """Warns once for the file, at the line that loads it.  limits: of joints that turn; rule: its unit of angles."""
    degrees = [name for name, own in limits.items() if look_like_degrees(own)]
    if degrees:
        warn(f"limits of joints {listed(degrees)} look like degrees; {rule} ({place})", DegreesWarning)
