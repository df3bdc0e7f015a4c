"""The mapping file's fields: which channels of a log are which quantity, and in what units and on which side.

`docs/log-mapping.md` says the same in prose and is checked against this.
"""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from cutpoint.formats.drives.sheet import Sheet, quantity, short


def _as_list(value: Any) -> Any:
    return [value] if isinstance(value, (str, float)) else value


def _as_channels(value: Any) -> Any:
    return {"channels": value} if isinstance(value, (str, list)) else value


def _as_channel(value: Any) -> Any:
    return {"channel": value} if isinstance(value, str) else value


def _as_units(value: Any) -> Any:
    """YAML takes the unit 1 for a number."""
    one = [value] if isinstance(value, (str, float)) else value
    return ["1" if type(unit) is float and unit == 1 else unit for unit in one] if isinstance(one, list) else one


def _of_channels(meaning: str) -> Any:
    return short("a channel's name, a list of names", meaning, None)


Numbers = Annotated[list[float], BeforeValidator(_as_list), Field(min_length=1)]
"""One for all joints, or one for each."""

Names = Annotated[list[str], BeforeValidator(_as_list), Field(min_length=1)]


class ChannelSheet(Sheet):
    """One quantity.  Its value is sign * gain * unit * what the log says, brought to the joint's side, plus offset."""

    channels: Names = Field(description="names in the log: one matrix, or one channel or column for each joint")
    unit: Annotated[Names | None, BeforeValidator(_as_units)] = Field(
        None, description="one for all joints, or one for each; what the log states for each, or SI, if not stated"
    )
    gain: Numbers | None = quantity("SI", "SI", "what one `unit` is worth: N m for each A, or V, or %", None)
    counts_per_turn: Annotated[list[Annotated[float, Field(gt=0)]], BeforeValidator(_as_list)] | None = quantity(
        "counts", "counts", "of an encoder whose unit is counts or counts/s, at the side that it is on", None
    )
    sign: Numbers = Field([1.0], description="1, or -1 where the log counts the other way than the robot")
    side: Literal["link", "motor"] = Field(
        "link",
        description="motor: as at the rotor's shaft; `ratio` divides positions and speeds, and multiplies torques",
    )
    offset: Numbers = quantity("SI", "SI", "added in the end, at the joint's side: where an encoder's zero lies", [0.0])


class TimeSheet(Sheet):
    """When samples were taken: a channel, or a period where the log has none."""

    channel: str | None = Field(None, description="of the log; the first that is named like a time, if not stated")
    unit: Literal["s", "ms", "us", "ns"] | None = Field(
        None, description="of the channel; what the log states, or s, if not stated"
    )
    period: float | None = quantity("s", "s", "between samples, instead of a channel", None, gt=0)
    start: float | None = quantity("s", "s", "after the first sample; earlier ones are left out", None, ge=0)
    end: float | None = quantity("s", "s", "after the first sample; later ones are left out", None, gt=0)


Quantity = Annotated[ChannelSheet | None, BeforeValidator(_as_channels)]


class MappingSheet(Sheet):
    """The file as a whole."""

    version: float = Field(description="1, that of this format")
    joints: Names | None = Field(None, description="names, in the order of columns; picks columns that the log labels")
    ratio: Numbers | None = quantity(
        "1", "rad/m", "signed motor turns per joint turn; the robot's drives', if not stated", None
    )
    time: Annotated[TimeSheet, BeforeValidator(_as_channel)] = short(
        "a channel's name", "when samples were taken", TimeSheet.model_validate({})
    )
    q: Quantity = _of_channels("position of the link")
    theta: Quantity = _of_channels("position of the motor")
    v: Quantity = _of_channels("speed of the link")
    theta_dot: Quantity = _of_channels("speed of the motor")
    torque: Quantity = _of_channels("torque or force of the motor, commanded or measured")
    current: Quantity = _of_channels("current of the motor")
