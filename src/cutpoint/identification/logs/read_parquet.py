"""Logs as Parquet files: a column per channel; lists of fixed length are a column per joint."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from cutpoint.arrays import Array
from cutpoint.errors import InputError
from cutpoint.identification.logs.table import Channel, Table, channel, check_size, optional, read_as
from cutpoint.model.stated_units import name_and_unit


def read_parquet(path: Path) -> Table:
    """Columns of numbers by name, the fields of structures as `rec.position`; dates and durations become seconds.

    Raises InputError: no Parquet file, or one that unpacks to more than is read; CutpointError if pyarrow is missing.
    """
    pyarrow = _pyarrow()
    # opened here, so that a path is never taken for a URL
    wrong = read_as("Parquet file", path, pyarrow.ArrowException, MemoryError)
    with wrong, path.open("rb") as stream, pyarrow.parquet.ParquetFile(stream) as file:
        check_size(max(_sizes(file.metadata)), "table", str(path))
        columns = [file.metadata.schema.column(k) for k in range(file.metadata.num_columns)]
        # texts are never numbers, and a single one may be encoded a million times
        table = _flat(pyarrow, file.read([each.path for each in columns if each.physical_type != "BYTE_ARRAY"]))
        kinds = {each.name: each.type for each in _flat(pyarrow, file.schema_arrow.empty_table()).schema}
    columns = zip(table.column_names, table.columns, strict=True)
    channels = {name: found for name, column in columns if (found := _channel(pyarrow, column))}
    left_out = {name: f"{kind}, not numbers" for name, kind in kinds.items() if name not in channels}
    return Table(str(path), _named(channels, str(path)), left_out)


def _named(channels: dict[str, Channel], place: str) -> dict[str, Channel]:
    """With the units that titles such as `q1 [deg]` state.  Raises InputError where this leaves a name twice."""
    found: dict[str, Channel] = {}
    for title, each in channels.items():
        name, unit = name_and_unit(title)
        if name in found:
            raise InputError(f"column {name!r} occurs twice: each name must be unique", place=place)
        found[name] = replace(each, unit=unit or each.unit)
    return found


def _pyarrow() -> Any:
    """The library, with the parts of it that are imported on their own."""
    found, *_ = (optional(name, "a Parquet file") for name in ("pyarrow", "pyarrow.compute", "pyarrow.parquet"))
    return found


def _sizes(about: Any) -> tuple[int, int]:
    """Bytes of a table as encoded, and of its decoded numbers: equal ones may be encoded as one."""
    groups = [about.row_group(k) for k in range(about.num_row_groups)]
    values = sum(group.column(k).num_values for group in groups for k in range(group.num_columns))
    rows = sum(group.num_rows for group in groups) * about.num_columns
    return sum(group.total_byte_size for group in groups), 8 * max(values, rows)


def _flat(pyarrow: Any, table: Any) -> Any:
    """A table with a column per field of its structures."""
    while any(pyarrow.types.is_struct(field.type) for field in table.schema):
        table = table.flatten()
    return table


def _channel(pyarrow: Any, column: Any) -> Channel | None:
    """A column as a channel; None for texts, and for lists that are empty or differ in length."""
    types, compute = pyarrow.types, pyarrow.compute
    if types.is_timestamp(column.type) or types.is_duration(column.type):
        return channel(_seconds(column), unit="s")
    lists = types.is_list(column.type) or types.is_fixed_size_list(column.type) or types.is_large_list(column.type)
    inner = column.type.value_type if lists else column.type
    if not (types.is_floating(inner) or types.is_integer(inner)):
        return None
    if not lists:
        return channel(column.to_numpy())
    lengths = compute.unique(compute.list_value_length(column)).to_pylist()
    if len(lengths) != 1 or not lengths[0] or column.null_count:
        return None
    return channel(column.combine_chunks().flatten().to_numpy(zero_copy_only=False).reshape(-1, *lengths))


def _seconds(column: Any) -> Array:
    """Seconds since the first, so that no digit is lost; NaN for missing ones."""
    found = column.to_numpy()
    known = found[~np.isnat(found)]
    since = found - known[0] if known.size else found - found
    return np.where(np.isnat(since), np.nan, since / np.timedelta64(1, "s"))
