"""The study of effects as tables, and as numbers for the results file."""

from collections.abc import Mapping

from cutpoint.reporting.page import Table, number, row
from cutpoint.studies import drive_effects as sizes
from cutpoint.studies.paper.effects_runs import MISTAKEN, Share, Shares, arm
from cutpoint.studies.paper.printed import JOINTS

NAMES = ("not known", "known")
"""To the feedforward."""


_COLUMNS = (
    "",
    "added: not known",
    "known",
    "share: not known",
    "known",
    "alone, share: not known",
    "known",
    "recovered [%]",
)


def tables(found: Shares) -> tuple[Table, ...]:
    rows = [_line(effect, found.added[effect], found.alone[effect]) for effect in sizes.EFFECTS]
    caption = (
        "The arm's RMS tracking error with each effect added to those above it, not known to the feedforward and "
        "known; the effect's share, by which the error grows; the same of the effect alone; and how much of the share "
        "feedforward recovers, added. 10^{−3} degrees."
    )
    return (
        Table("Table A5", caption, _COLUMNS, tuple(rows)),
        _by_joint("Table A6", "each effect added to those above it", found.added),
        _by_joint("Table A7", "each effect alone", found.alone),
    )


def _line(effect: str, added: Share, alone: Share) -> tuple[str, ...]:
    cells = (arm(added.unknown), arm(added.known), *added.costs, *alone.costs)
    return effect, *(number(1e3 * x, 2) for x in cells), number(100 * added.recovered, 1)


def _by_joint(label: str, what: str, found: Mapping[str, Share]) -> Table:
    rows = [row("none", 1e3 * next(iter(found.values())).before, 2)]
    for effect, share in found.items():
        errors = zip(NAMES, (share.unknown, share.known), strict=True)
        rows += [row(f"{effect}: {name}", 1e3 * error, 2) for name, error in errors]
    return Table(label, f"RMS tracking errors of the links, {what}, 10^{{−3}} degrees.", ("", *JOINTS), tuple(rows))


def results(found: Shares) -> dict[str, dict[str, object]]:
    settings = {
        "gears": sizes.GEARS,
        "presliding": {"distance": sizes.DISTANCE, "damping": sizes.BRISTLE_DAMPING, "elastic": sizes.ELASTIC},
        "motor": {"bandwidth": sizes.BANDWIDTH, "delay": sizes.DELAY, "cogging": sizes.COGGING},
        "ripple": {f"{wave.order} a turn": wave.amplitude for wave in sizes.RIPPLE_WAVES},
        "asymmetry": sizes.LEANING,
        "grease": {"temperature": sizes.TEMPERATURE, "thinning": sizes.THINNING},
    }
    table = {
        "unit": "deg",
        "settings": settings,
        "without effects": found.added[sizes.EFFECTS[0]].before,
        "added": {effect: _numbers(share) for effect, share in found.added.items()},
        "alone": {effect: _numbers(share) for effect, share in found.alone.items()},
        "feedforward_of_linear_springs": found.ignorant,
        "gear_friction_mistaken": {"taken_for": MISTAKEN, "alone": found.mistaken},
    }
    return {"table_a5": table}


def _numbers(share: Share) -> dict[str, object]:
    unknown, known = share.costs
    return {
        "not_known": share.unknown,
        "known": share.known,
        "arm": {"before": arm(share.before), "not_known": arm(share.unknown), "known": arm(share.known)},
        "share": {"not_known": unknown, "known": known},
        "recovered": share.recovered,
    }
