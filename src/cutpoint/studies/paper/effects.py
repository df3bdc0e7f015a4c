"""The effects of a real drive, switched on one by one: the cost of each, and how much feedforward recovers."""

from collections.abc import Mapping

import numpy as np

from cutpoint.formats.catalogue.catalogue import catalogue_drive
from cutpoint.mechanics.drives.friction import STATED_AT, Coulomb
from cutpoint.model.units import ARC_MINUTE
from cutpoint.reporting.page import Page, Picture, listed, number
from cutpoint.robot import Robot
from cutpoint.studies import drive_effects as sizes
from cutpoint.studies.paper import effects_bars, effects_figures
from cutpoint.studies.paper.bench import KP, PERIOD, Bench
from cutpoint.studies.paper.effects_runs import MISTAKEN, Runs, Share, Shares, arm, shares
from cutpoint.studies.paper.effects_tables import NAMES, results, tables
from cutpoint.studies.paper.printed import DURATION

NEGLIGIBLE = 0.01
"""Share of the largest cost: smaller ones are not worth compensation."""

MOSTLY = 0.95
"""Of an effect's cost: recovered all but wholly."""


def page(bench: Bench) -> Page:
    runs = Runs(bench)
    # whose errors shares need, too
    known = {name: runs.log((sizes.ERROR,), effects) for name, effects in zip(NAMES, ((), (sizes.ERROR,)), strict=True)}
    found = shares(runs)
    pictures = (
        Picture("Figure A5", _CAPTION, effects_figures.figure(bench.robot.drives["joint2"], known)),
        Picture(
            "Figure A6",
            "What each effect adds to the arm's RMS tracking error, from Table A5: (a) on top of those above it, (b) "
            "alone. The axis is logarithmic; where the error grows by less than its beginning, or falls, there is a "
            "number and no bar.",
            effects_bars.figure(found),
        ),
    )
    blocks = (*_setting(bench.robot), pictures[0], *tables(found), pictures[1], *readings(found), _limits())
    return Page("effects", "The drive's effects, one by one", blocks, results(found))


def _setting(robot: Robot) -> tuple[str, ...]:
    gears = zip(robot.drives.values(), sizes.GEARS, strict=True)
    detents = [sizes.detent_stiffness(drive, gear) for drive, gear in gears]
    return (
        "The drives of Table 4 bend and rub, and do nothing else. Here the arm gets drives of the same sizes with what "
        "catalogues and textbooks know of real ones, switched on one after another: "
        f"{', '.join(sizes.EFFECTS)}. The move is (57) in {DURATION:g} s, the gains are those of Table 4, and the "
        "feedforward has all rungs. Each effect is run twice: under the feedforward of drives that lack it, and under "
        "that of the drives as they are. Its share is what the links' RMS error grows by when it is switched on. The "
        "arm's one number is the RMS over its joints. Without effects the springs are linear, with the catalogue's "
        "K_{1}, and nothing rubs: Table 4 shows what the friction of Table 2 costs.",
        _gear_sizes(),
        f"Presliding: the same friction as bristles that slide at {1e3 * sizes.DISTANCE:g} mrad at the joint and hold "
        f"up to {100 * sizes.ELASTIC:g} % of breakaway. Current loops of {sizes.BANDWIDTH:g} Hz get their commands "
        f"{1e6 * sizes.DELAY:g} µs late. Torque ripples by {_ripple()} of itself, "
        f"{' and '.join(str(wave.order) for wave in sizes.RIPPLE_WAVES)} times a motor turn, as 4 pole pairs do, and "
        f"cogs {sizes.COGGING_ORDER} times (12 slots) by {100 * sizes.COGGING:g} % of the torque that the gear is "
        f"rated for, as stiff as {listed(detents, 0)} N m/rad at joints 1 to 6, where K_{{p}} is {listed(KP, 0)}. Dry "
        f"friction is {100 * sizes.LEANING:g} % larger forwards and smaller backwards; at "
        f"{sizes.TEMPERATURE:g} °C viscous friction is {_thicker():.1f} times that at {STATED_AT} °C. These sizes are "
        "ours, common for such drives. Presliding, asymmetry and cold grease change friction, so alone they are set "
        "beside drives with gear friction.",
    )


def _gear_sizes() -> str:
    """Out of the catalogue, by size."""
    gears = [catalogue_drive(name) for name in dict.fromkeys(sizes.GEARS)]
    frictions = [gear.motor_friction for gear in gears]
    laws = [law for law in frictions if isinstance(law, Coulomb)]
    errors = [gear.kinematic_error for gear in gears]
    amplitudes = [wave.amplitude / ARC_MINUTE for error in errors for wave in getattr(error, "harmonics", ())]
    return (
        f"Stiffness, kinematic error and hysteresis are those of the package's catalogue entries "
        f"{', '.join(dict.fromkeys(sizes.GEARS))}: three slopes; {listed(amplitudes, 2)} arc minutes, half of the "
        "accuracy stated, twice a turn of the wave generator; and a loss of one arc minute. Gear friction acts on the "
        "motor's side. No source gives these gears' own; it is that of gears of the same size by another maker "
        "(RT1-H-CS), as a third party transcribes them: the starting torque is the dry part, "
        f"{listed([law.coulomb for law in laws])} N m at the joint; the running torque at 2000 rpm less that gives the "
        f"viscous part, {listed([law.viscous for law in laws])} N m s/rad; and what the stated efficiency lacks beyond "
        f"both is taken from the load, {listed([100 * (law.per_load or 0) for law in laws])} % of it."
    )


def _ripple() -> str:
    return " and ".join(f"{100 * wave.amplitude:.1f} %" for wave in sizes.RIPPLE_WAVES)


def _thicker() -> float:
    return float(np.exp(sizes.THINNING * (STATED_AT - sizes.TEMPERATURE)))


def readings(found: Shares) -> tuple[str, ...]:
    """Findings from the numbers."""
    ranked = sorted(found.added, key=lambda effect: -found.added[effect].costs[0])
    first, second = (found.added[effect].costs[0] for effect in ranked[:2])
    small = [effect for effect in ranked if found.added[effect].costs[0] < NEGLIGIBLE * first]
    order = ", ".join(f"{effect} {_milli(found.added[effect].costs[0])}" for effect in ranked)
    ignorant, knowing = arm(found.ignorant), arm(found.added[sizes.EFFECTS[-1]].known)
    return (
        f"What matters: not known to the feedforward, the effects' shares are, in 10^{{−3}} degrees, {order}. The "
        f"first is {first / second:.1f} times the second. Less than {100 * NEGLIGIBLE:g} % of the first: "
        f"{', '.join(small) or 'none'}. With all of them and a feedforward of linear springs the arm is off by "
        f"{_milli(ignorant)}; with one that knows them, by {_milli(knowing)}, {ignorant / knowing:.0f} times less.",
        _what_comes_back(found.added),
        f"Knowing is the hard part. A feedforward that takes gear friction, alone, for {MISTAKEN:g} of what it is "
        f"leaves {_milli(arm(found.mistaken))}, where one that knows it leaves "
        f"{_milli(arm(found.alone[sizes.FRICTION].known))}, and one without friction "
        f"{_milli(arm(found.alone[sizes.FRICTION].unknown))}.",
    )


def _what_comes_back(added: Mapping[str, Share]) -> str:
    """Effects sorted by how much of each the feedforward recovers."""
    groups: dict[str, list[str]] = {"all but wholly": [], "in part": [], "not": []}
    for effect, share in added.items():
        groups[_how(share)].append(f"{effect} {100 * share.recovered:.0f} %")
    words = "; ".join(f"{how}: {', '.join(effects) or 'none'}" for how, effects in groups.items())
    left = max(added, key=lambda effect: added[effect].costs[1])
    text = f"What a feedforward takes back of an effect that it knows: {words}."
    if any(share.recovered > 1.005 for share in added.values()):
        text += " More than all of it comes back where an effect also damps what the others leave."
    if _how(added[sizes.LAG]) == "not":
        text += " Feedforward has no term for the current loop and its delay; what they cost stays."
    return text + f" The largest share that is left is that of {left}, {_milli(added[left].costs[1])}."


def _how(share: Share) -> str:
    if share.recovered >= MOSTLY:
        return "all but wholly"
    return "in part" if share.recovered >= NEGLIGIBLE else "not"


def _milli(degrees: float) -> str:
    """In 1e-3 deg."""
    return number(1e3 * degrees, 2)


def _limits() -> str:
    return (
        "What this can say: which effects are worth identifying on such an arm in such a move, and that the equations "
        "compensate what they are told. What it cannot say: how well an effect can be known. But for the last number "
        "the feedforward's numbers are the plant's own, to the phase of every wave; encoders are perfect; and the "
        f"command is held for {1e3 * PERIOD:g} ms while waves and strains go on. Shares depend on gains, which turn "
        "torques into errors, and on the move: a faster one makes waves dynamic and lag dearer."
    )


_CAPTION = (
    "The effects as laws, on the drive of joint 2 (size 20). (a) Torque over deflection with the wave generator "
    "blocked, wound to and fro, with minor loops. (b) Friction over speed by (54) with Table 2, symmetric and not. (c) "
    "Gear friction at the joint's side, asymmetric, without and under load, and in the cold. (d) Friction of a slow "
    "motion to and fro, with a small one in it. (e) Kinematic error over a turn of the wave generator. (f) Tracking "
    "error by waves a turn, in the middle of the move, with the kinematic error alone, known to the feedforward and "
    "not. (g) What is added to the motor's rated torque over a quarter turn, and (h) its waves a turn, with that "
    "torque and without."
)
