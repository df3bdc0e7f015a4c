"""Validation of a part of a drive file: pydantic's errors reworded, each with its field, value and line."""

import reprlib
from dataclasses import dataclass
from typing import Any, TypeVar, get_args

from pydantic import ValidationError
from pydantic.fields import FieldInfo

from cutpoint.errors import ModelError, close_to, listed
from cutpoint.formats.drives.sheet import Sheet
from cutpoint.formats.safe_yaml import YamlDocument, YamlPath

S = TypeVar("S", bound=Sheet)

_RULES = {
    "finite_number": "must be finite",
    "float_type": "must be a number",
    "string_type": "must be text",
    "bool_type": "must be true or false",
    "list_type": "must be a list",
    "dict_type": "must be a mapping of fields",
}

_BOUNDS = {
    "greater_than": "above",
    "greater_than_equal": "at least",
    "less_than": "below",
    "less_than_equal": "at most",
}


@dataclass(frozen=True)
class Section:
    """The part of a file described by one sheet.

    thing: the subject of messages; roots: where its values may be in the file, the likelier first.
    slides: whether units are those of a prismatic joint.
    """

    thing: str
    document: YamlDocument
    roots: tuple[YamlPath, ...]
    slides: bool = False

    def read(self, sheet: type[S], value: Any) -> S:
        """The values as a sheet.  Raises ModelError for the first that breaks a rule; an unknown key comes first."""
        try:
            return sheet.model_validate(value)
        except ValidationError as problem:
            details = sorted(problem.errors(include_url=False), key=lambda detail: detail["type"] != "extra_forbidden")
            raise self._translated(sheet, details[0]) from None

    def error(self, path: YamlPath, complaint: str) -> ModelError:
        """An error at the line of a field."""
        told, field = f"{self.thing}: {complaint}", ".".join(path)
        return ModelError(told, place=self.place(path), thing=self.thing, field=field)

    def place(self, path: YamlPath) -> str:
        """The line of a field."""
        return self.document.place(*((*root, *path) for root in self.roots))

    def is_stated(self, path: YamlPath) -> bool:
        """Whether the file itself has a field."""
        return any((*root, *path) in self.document.lines for root in self.roots)

    def stated(self, sheet: type[Sheet], path: YamlPath, value: Any) -> str:
        """`compliance.linear.stiffness -3.0 N m/rad`."""
        unit = self.unit(field_of(sheet, path))
        shown = repr(value) if isinstance(value, float) else reprlib.repr(value)
        return " ".join(filter(None, (".".join(path), shown, unit if isinstance(value, float) else "")))

    def unit(self, field: FieldInfo | None) -> str:
        """Unit of a field on this joint; empty if it has none."""
        unit = _extra(field, "linear_unit" if self.slides else "unit")
        return "" if unit == "1" else unit

    def _translated(self, sheet: type[Sheet], detail: Any) -> ModelError:
        path: YamlPath = tuple(str(part) for part in detail["loc"])
        kind = detail["type"]
        owner = sheet_at(sheet, path[:-1])
        key, within = "".join(path[-1:]), f" in {'.'.join(path[:-1])}" if len(path) > 1 else ""
        if kind == "extra_forbidden" and owner:
            meant = next((f"; did you mean {x!r}?" for x in close_to(key, owner.model_fields)), "")
            known = listed(owner.model_fields)
            return self.error(path, f"unknown key {key!r}{within}; known keys: {known}{meant}")
        if kind == "missing":
            field = field_of(sheet, path)
            unit, told = self.unit(field), f": {field.description}" if field and field.description else ""
            return self.error(path, f"{key!r}{f' ({unit})' if unit else ''} is missing{within}{told}")
        return self.error(path, f"{self.stated(sheet, path, detail['input'])} {self._rule(sheet, path, detail)}")

    def _rule(self, sheet: type[Sheet], path: YamlPath, detail: Any) -> str:
        nested = sheet_at(sheet, path)
        if detail["type"] == "model_type" and nested:
            short = _extra(field_of(sheet, path), "short")
            return f"must be {f'{short} or ' if short else ''}a mapping with keys from {listed(nested.model_fields)}"
        if detail["type"] == "literal_error":
            return f"must be {detail['ctx']['expected']}"
        if detail["type"] == "dict_type" and (field := field_of(sheet, path)):
            return f"must be a mapping: {field.description}"
        if detail["type"] in ("list_type", "too_short", "too_long") and path[-1:] and path[-1].isdigit():
            field = field_of(sheet, path)
            return f"must be one entry of: {field.description if field else ''}"
        if detail["type"] == "float_type" and isinstance(detail["input"], str) and "," in detail["input"]:
            return "must be a number, written without commas"
        context = detail.get("ctx", {})
        match detail["type"]:
            case "greater_than" | "greater_than_equal" if not context.get("gt", context.get("ge")):
                return "must be positive" if "gt" in context else "must not be negative"
            case "greater_than" | "greater_than_equal" | "less_than" | "less_than_equal" as kind:
                return f"must be {_BOUNDS[kind]} {next(iter(context.values())):g}"
            case "too_short":
                return f"must have at least {context['min_length']} entries"
            case "too_long":
                return f"must have at most {context['max_length']} entries"
        return _RULES[detail["type"]]


def _extra(field: FieldInfo | None, name: str) -> str:
    """A sheet's metadata on a field besides its type and rules; empty if there is none."""
    extra = field.json_schema_extra if field else None
    return str(extra.get(name, "")) if isinstance(extra, dict) else ""


def sheet_at(sheet: type[Sheet], path: YamlPath) -> type[Sheet] | None:
    """The sheet that a path of keys leads to."""
    for key in path:
        field = sheet.model_fields.get(key)
        choices = (field.annotation, *get_args(field.annotation)) if field else ()
        nested = [choice for choice in choices if isinstance(choice, type) and issubclass(choice, Sheet)]
        if not nested:
            return None
        sheet = nested[0]
    return sheet


def field_of(sheet: type[Sheet], path: YamlPath) -> FieldInfo | None:
    """The field that a path of keys names; for an entry of a list, the list."""
    while path and path[-1].isdigit():
        path = path[:-1]
    owner = sheet_at(sheet, path[:-1])
    return owner.model_fields.get(path[-1]) if owner and path else None
