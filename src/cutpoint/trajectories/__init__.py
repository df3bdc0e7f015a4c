"""References with as many time derivatives as elastic joints need."""

from cutpoint.trajectories.csv_file import from_csv
from cutpoint.trajectories.cycloid import cycloid
from cutpoint.trajectories.polynomial import quintic, septic
from cutpoint.trajectories.retimed import retimed
from cutpoint.trajectories.samples import from_samples
from cutpoint.trajectories.trajectory import Sample, Trajectory
from cutpoint.trajectories.waypoints import waypoints

__all__ = ["Sample", "Trajectory", "cycloid", "from_csv", "from_samples", "quintic", "retimed", "septic", "waypoints"]
