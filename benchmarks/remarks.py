"""What each section is to reach, and where the time goes in rows that do not."""

TARGETS = {
    "one call": 1.0, "batch": 1.0, "elastic": 1.0, "long chains": 1.0, "from Python": 1.0, "closed loop": 1.0,
    "from memory": 0.5,
}  # fmt: skip
"""How many times as quick as the quickest peer; of memory: the share of what it can do at most."""

_FRAMES = "the kernel takes a fifth of it, and what looks up the frame and the variant, in Python, all the rest."
_STORES = "the matrix leaves number by number, kilobytes a row, which no recursion saves; CasADi's does too."
_SETTING_UP = "its steps are quicker, see below; checks, references and log, some 2 ms a call of `simulate`, are not."

REMARKS = {
    ("from Python", "UR10 Jacobian"): _FRAMES, ("from Python", "Panda Jacobian"): _FRAMES,
    ("one call", "UR10 regressor"): _STORES, ("one call", "Panda regressor"): _STORES,
    ("closed loop", "UR10"): _SETTING_UP, ("closed loop", "Panda"): _SETTING_UP,
}  # fmt: skip
"""By section and by the row's first cells, joined by a blank: a sentence."""


def missed(section: str, row: str, reached: float | None) -> str | None:
    """The line under a table on a row that does not reach its target."""
    target = TARGETS.get(section)
    if target is None or reached is None or reached >= target:
        return None
    told = REMARKS.get((section, row), "where the time goes is not yet said here.")
    return f"* {row}: {reached:.2f} of the {target:g} wanted; {told}"
