"""What one inverse dynamics costs against the number of joints, for formulations old and new through one emitter."""

from cutpoint.studies.cost.study import run

__all__ = ["run"]
