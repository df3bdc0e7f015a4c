"""A log as a pandas DataFrame."""

from typing import Any

from cutpoint.errors import CutpointError
from cutpoint.simulation.log.log import Log, column_name


def frame(log: Log) -> Any:
    """Index `time` in s, one column for each joint of each channel; `attrs` holds units by column, and meta."""
    try:
        import pandas
    except ImportError as error:
        raise CutpointError("to_dataframe needs pandas: pip install 'cutpoint[pandas]'") from error
    columns: dict[str, Any] = {}
    units: dict[str, str] = {}
    for name, values in log.channels.items():
        for column, (joint, unit) in enumerate(log.columns(name)):
            title = column_name(name, joint)
            columns[title] = values.reshape(log.time.size, -1)[:, column]
            units[title] = unit
    table = pandas.DataFrame(columns, index=pandas.Index(log.time, name="time"))
    table.attrs.update(units=units, meta=log.meta)
    return table
