"""All control laws on one plant at equal stiffness, each departure from the model on its own."""

from cutpoint.studies.compare.study import run

__all__ = ["run"]
