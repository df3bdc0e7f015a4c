"""Schema of a gear or actuator in the packaged catalogue: groups of numbers, each with its source."""

from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from cutpoint.formats.drives.sheet import Sheet, quantity


class Source(Sheet):
    """Where a group was read.  read: how, where it was not a table."""

    key: str
    title: str
    document: str = ""
    pages: str = ""
    address: str = ""
    read: str = ""


class Group(Sheet):
    """Numbers of one source.  verified: whether they were read on a page of the maker's document."""

    source: Source
    verified: bool

    @property
    def status(self) -> str:
        """Reliability of the numbers, in a word or two."""
        return "verified" if self.verified else "recalled" if self.source.key == "recalled" else "not verified"


def _q(unit: str, meaning: str, default: Any = ...) -> Any:
    return quantity(unit, unit, meaning, default, gt=0)


def _whole(value: Any) -> Any:
    return int(value) if isinstance(value, float) and value.is_integer() else value


def _tuples(value: Any) -> Any:
    return tuple(map(_tuples, value)) if isinstance(value, list) else value


Whole = Annotated[int, BeforeValidator(_whole)]


class Stiffness(Group):
    t1: float = _q("N m", "torque T1")
    t2: float = _q("N m", "torque T2")
    k1: float = _q("N m/rad", "stiffness K1, up to T1")
    k2: float = _q("N m/rad", "stiffness K2, up to T2")
    k3: float = _q("N m/rad", "stiffness K3, beyond")


class Accuracy(Group):
    transmission_arcmin: float = _q("arcmin", "transmission accuracy, peak to peak")


class Hysteresis(Group):
    loss_arcmin: float = _q("arcmin", "hysteresis loss")
    lost_motion_arcmin: float | None = _q("arcmin", "lost motion", None)


class GearRatings(Group):
    rated: float = _q("N m", "rated torque")
    average: float = _q("N m", "largest average torque")
    repeated_peak: float = _q("N m", "repeated peak torque")
    momentary_peak: float = _q("N m", "momentary peak torque")
    rated_rpm: float = _q("rpm", "rated input speed")


class Speeds(Group):
    maximum_rpm: float = _q("rpm", "largest input speed")
    average_rpm: float = _q("rpm", "largest average input speed")


class Life(Group):
    hours: float = _q("h", "life at rated torque and speed")
    basis: str = Field(description="reached by (L10: nine of ten)")


class Overload(Group):
    ratcheting: float = _q("N m", "ratcheting torque")
    buckling: float = _q("N m", "buckling torque of the flexspline")


class GearInertia(Group):
    wave_generator: float = _q("kg m2", "inertia of the wave generator")


class Starting(Group):
    torque: float = _q("N m", "starting torque at the input")


class Running(Group):
    """points: (rpm of the input, N m at the input), unloaded."""

    points: Annotated[tuple[tuple[float, float], ...], BeforeValidator(_tuples)]
    celsius: float | None = quantity("deg C", "deg C", "temperature of the running torque", None)


class Efficiency(Group):
    """points: (rpm of the input, N m at the output, efficiency)."""

    points: Annotated[tuple[tuple[float, float, float], ...], BeforeValidator(_tuples)]
    celsius: float | None = quantity("deg C", "deg C", "temperature of the efficiency", None)


class Likeness(Group):
    """Friction taken over from another gear: its torque at the input times `scale`, its share of the load."""

    like: str = Field(description="friction as of")
    scale: float = _q("1", "input torque times", 1.0)

    @property
    def status(self) -> str:
        return "estimate"


class Mass(Group):
    kg: float = _q("kg", "mass")


class MotorGroup(Group):
    torque_constant: float = _q("N m/A", "torque constant at the shaft")
    emf_constant: float | None = _q("V s/rad", "EMF constant", None)
    resistance: float = _q("ohm", "resistance")
    inductance: float = _q("H", "inductance")
    current_peak: float = _q("A", "largest current")
    voltage: float | None = _q("V", "DC supply", None)
    ac_supply: float | None = _q("V", "AC supply, rms", None)
    inertia: float = _q("kg m2", "inertia of the rotor")
    pole_pairs: Whole | None = _q("1", "pole pairs", None)
    viscous: float = quantity("N m s/rad", "N m s/rad", "viscous friction at the shaft", 0.0, ge=0)
    coulomb: float = quantity("N m", "N m", "Coulomb friction at the shaft", 0.0, ge=0)


class Output(Group):
    maximum_torque: float | None = _q("N m", "largest torque of the actuator", None)
    maximum_rpm: float = _q("rpm", "largest speed of the joint")
    inertia: float | None = _q("kg m2", "inertia at the joint", None)
    spring: float | None = _q("N m/rad", "spring in series with the gear", None)


class Encoder(Group):
    kind: str = Field(description="encoder")
    place: str = Field(description="encoder at the")
    counts_per_turn: Whole = _q("1", "counts for each turn")


class CatalogueGear(Sheet):
    """A gear, or an actuator with its gear; groups without a source are None."""

    name: str
    maker: str
    series: str
    size: Whole
    ratio: Whole
    stiffness: Stiffness | None = None
    accuracy: Accuracy | None = None
    hysteresis: Hysteresis | None = None
    ratings: GearRatings | None = None
    speeds: Speeds | None = None
    life: Life | None = None
    overload: Overload | None = None
    inertia: GearInertia | None = None
    starting: Starting | None = None
    running: Running | None = None
    efficiency: Efficiency | None = None
    friction: Likeness | None = None
    mass: Mass | None = None
    motor: MotorGroup | None = None
    output: Output | None = None
    encoder: Encoder | None = None

    @property
    def groups(self) -> dict[str, Group]:
        """The groups that there are, by name."""
        return {name: value for name, value in self if isinstance(value, Group)}
