"""Section IV of Xia et al. (2019) computed again, as a report."""

from cutpoint.studies.paper.study import run

__all__ = ["run"]
