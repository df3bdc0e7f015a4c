"""One entry of a drive file to a `Drive`: pydantic's complaints in our words, and the rules that join several fields."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeVar, get_args

import numpy as np
from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from cutpoint.errors import ModelError
from cutpoint.formats.drive_sheet import Sheet
from cutpoint.formats.safe_yaml import YamlDocument, YamlPath

S = TypeVar("S", bound=Sheet)
