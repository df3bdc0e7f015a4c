"""Interpretation of channel names: quantity, joint or number, and whether it was measured or commanded."""

import re
from collections.abc import Iterable, Sequence

from cutpoint.model.stated_units import LONGEST_NAME

TIME = ("time", "t", "timestamp", "timestamps", "stamp", "stamps", "timesec", "times")
"""Names of times; only letters and digits count, for the other names only letters, and only the end of a path."""

NAMES = {
    "q": (
        "measuredq",
        "q",
        "actualq",
        "position",
        "positions",
        "pos",
        "jointposition",
        "jointpositions",
        "linkposition",
    ),
    "theta": ("measuredtheta", "theta", "motorposition", "motorpositions", "qmotor"),
    "v": ("measuredv", "v", "qd", "dq", "qdot", "actualqd", "velocity", "velocities", "vel", "jointvelocity"),
    "theta_dot": ("measuredthetadot", "thetadot", "motorvelocity", "motorvelocities", "dtheta", "qdmotor"),
    "torque": ("motortorque", "tau", "torque", "torques", "effort", "efforts", "actualtorque", "commandtorque"),
    "current": (
        "current",
        "currents",
        "motorcurrent",
        "motorcurrents",
        "actualcurrent",
        "jointcurrent",
        "jointcurrents",
    ),
}
"""Names of each quantity, the likeliest first."""


JOINT_NAMES = frozenset(("name", "names", "jointname", "jointnames"))
"""Names of columns whose text is the name of a joint."""

KNOWN = frozenset(name for names in NAMES.values() for name in names)

WISHED = re.compile(r"(desired|des|target|command|commanded|cmd|reference|ref|setpoint|goal|demand)s?", re.I)
"""Words in the names of commanded quantities; another column of the same name is then the measured one."""


def time_channel(names: Iterable[str]) -> str | None:
    """The first channel with a name of a time."""
    found = {re.sub(r"[^a-z0-9]", "", _end(_timed(name)[0]).lower()): name for name in reversed(list(names))}
    return next((found[name] for name in TIME if name in found), None)


def unit_of_time(name: str) -> str:
    """The unit at the end of a time's name, `timestamp_ms`, or ""."""
    return _timed(name)[1]


def _timed(name: str) -> tuple[str, str]:
    """A name without the unit of time at its end, and that."""
    found = re.fullmatch(r"(.*)_(ms|us|ns)", name, re.I)
    return (found[1], found[2].lower()) if found else (name, "")


def is_wished(name: str) -> bool:
    """Whether a word of a name marks a command."""
    return any(WISHED.fullmatch(word) for word in re.split(r"[^A-Za-z]+", name))


def name_and_label(name: str, joints: Sequence[str], known: frozenset[str] = KNOWN) -> tuple[str, str]:
    """The letters of a column's name without its joint or number, and that label: `q_elbow`, `q.elbow`, `q1`.

    known: letters that have a meaning.
    """
    if len(name) > LONGEST_NAME:
        return "", name
    # longest first: `elbow_2` is not `elbow`
    for joint in sorted(joints, key=len, reverse=True):
        before, there, after = _parted(name, joint)
        rest = letters(f"{before}{after}".strip("._-/ []()"))
        if there and rest in known:
            return rest, joint
    numbered = re.fullmatch(r"(.*?)[\s_/-]*[\[(]?(\d+)[\])]?", name)
    if numbered and letters(numbered[1]) in known:
        return letters(numbered[1]), str(int(numbered[2]))
    if letters(name) in known:
        within = re.findall(r"\d+", _end(name))
        return letters(name), str(int(within[0])) if len(within) == 1 else ""
    stem, _, label = name.rpartition(".")
    return letters(stem), label


def _parted(name: str, joint: str) -> tuple[str, str, str]:
    """The text before a joint's name, that name as a whole word, and the text after it."""
    found = re.search(rf"(?<![A-Za-z0-9]){re.escape(joint)}(?![A-Za-z0-9])", name)
    return (name[: found.start()], joint, name[found.end() :]) if found else (name, "", "")


def letters(name: str) -> str:
    """Letters of the end of a path, in lower case."""
    return re.sub(r"[^a-z]", "", _end(name).lower())


def _end(path: str) -> str:
    return re.split(r"[./]", path)[-1]
