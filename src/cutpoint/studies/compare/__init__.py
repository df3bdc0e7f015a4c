"""All control laws on one plant at equal stiffness, each departure from the model on its own."""

from cutpoint.studies.compare.bench import bench_of
from cutpoint.studies.compare.panda_arm import panda
from cutpoint.studies.compare.study import run

__all__ = ["bench_of", "panda", "run"]
