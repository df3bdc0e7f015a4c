"""Optimal excitation trajectories."""
