"""Drives of any structures as rows of numbers: a row has room for one of each structure, and the number of its own."""

from collections.abc import Sequence

import numpy as np

from cutpoint.mechanics.system import Driven
from cutpoint.model.drive import Drive
from cutpoint.scalars import leaves, structure_of

Model = Drive | None
"""A drive whose structure others share; None for joints without a drive."""


def models_of(bodies: range, drives: Sequence[Driven]) -> list[Model]:
    """The first drive of each structure."""
    first: dict[object, Model] = {}
    for driven in drives:
        first.setdefault(structure_of(driven.drive), driven.drive)
    return [*first.values(), *([None] if drives and len(drives) < len(bodies) else [])]


def drive_rows(bodies: range, drives: Sequence[Driven]) -> np.ndarray:
    """(n, ...) for each body the number of its drive's model, then a drive's numbers for every model.

    Where the drive has another structure they are the model's own: numbers that all bodies share may become code.
    """
    own, models = {driven.segment: driven.drive for driven in drives}, models_of(bodies, drives)
    kinds = [structure_of(model) for model in models]
    rows = np.array([[0, *leaves(models)]] * len(bodies) if drives else [[]] * len(bodies), dtype=np.float64)
    ends = np.cumsum([1, *(len(leaves(model)) for model in models)])
    for row, i in zip(rows, bodies, strict=True) if drives else ():
        row[0] = kind = kinds.index(structure_of(own.get(i)))
        row[ends[kind] : ends[kind + 1]] = leaves(own.get(i))
    return rows
