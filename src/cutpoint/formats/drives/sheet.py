"""What all parts of a drive file's schema share: strict fields that state their unit, meaning and rule."""

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field
from pydantic.config import JsonDict


def quantity(rotary: str, linear: str, meaning: str, default: Any = ..., **rules: Any) -> Any:
    """A field with its unit on a joint that turns and on one that slides, and rules such as `gt=0`."""
    units: JsonDict = {"unit": rotary, "linear_unit": linear}
    return Field(default, description=meaning, json_schema_extra=units, **rules)


def short(word: str, meaning: str, default: Any) -> Any:
    """A field that holds a mapping, or `word` in its place."""
    return Field(default, description=meaning, json_schema_extra={"short": word})


class Sheet(BaseModel):
    """Unknown keys are errors, and nothing is converted.  Validators are built at their first use, for quick starts."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False, defer_build=True)


Wave = Annotated[list[float], Field(min_length=3, max_length=3)]
"""[order, amplitude, phase] of one wave a turn of the rotor."""


class WaveSheet(Sheet):
    """A wave over the rotor's turn, and further ones; each kind of wave states the unit of its amplitude."""

    amplitude: float
    order: float = quantity("1", "1", "waves for each turn of the rotor, a whole number", ge=1)
    phase: float = quantity("rad", "rad", "of the wave where the joint's coordinate is zero", 0.0)
    harmonics: list[Wave] = Field([], description="further waves, each [order, amplitude, phase]")
