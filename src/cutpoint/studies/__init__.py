"""Studies that write reports: the paper's section IV, laws compared, costs, drives, sizing."""
